"""Expressions of scene and study files: arithmetic and comparisons of named numbers, and nothing else.

simpleeval walks the parsed text; of what it can do we leave in names, numbers, text, arithmetic, comparisons, ``and``,
``or``, ``not``, and a few functions. Names may stand for arrays, so that one walk answers for all rows of a table, each
row with the bits that it has by itself. What by itself is an error is NaN, and false as the answer of a comparison.
"""

from __future__ import annotations

import ast
import math
import operator
import unicodedata
from collections.abc import Callable, Mapping
from functools import reduce
from typing import Any, ClassVar

import numpy as np
from simpleeval import FeatureNotAvailable, FunctionNotDefined, NameNotDefined, OperatorNotDefined, SimpleEval

LONGEST_FORMULA = 1000
"""Characters: what is longer is no formula of a person, and deep nesting would end Python's stack."""
_ALLOWED = "write numbers, names, + - * / **, comparisons, and, or, not"


class Expression:
    """One expression, parsed.

    Attributes
    ----------
    text
        As it was written.

    Raises
    ------
    ValueError
        It is no expression, or holds what none may; the message says what, and the remedy.

    >>> Expression("1 + play / 2").value({"play": 0.5})
    1.25
    """

    functions: ClassVar[Mapping[str, Callable[..., Any]]]
    """Those that it may call."""

    def __init__(self, text: str) -> None:
        self.text = text.strip()
        if len(self.text) > LONGEST_FORMULA:
            raise ValueError(f"has {len(self.text)} characters; write a formula of at most {LONGEST_FORMULA}")
        try:
            self._tree = ast.parse(self.text, mode="eval").body
        except (SyntaxError, ValueError, MemoryError, RecursionError):
            raise ValueError(f"is no expression ({_short(self.text)}); {self._allowed}") from None

    @property
    def _allowed(self) -> str:
        return f"{_ALLOWED}, {', '.join(self.functions)}"

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {_short(self.text)!r}>"

    def value(self, names: Mapping[str, Any]) -> Any:
        """Return what it comes to; ``names`` are numbers, text, or arrays of either.

        Raises
        ------
        ValueError
            An unknown name, something else than arithmetic and comparisons, or a number that there is not.
        """
        evaluator = _Evaluator({_read_as(name): value for name, value in names.items()}, self.functions)
        try:
            with np.errstate(all="ignore"):
                return evaluator.known(evaluator.eval(self.text, previously_parsed=self._tree))
        except NameNotDefined as error:
            known = ", ".join(names) or "none"
            texts = [name for name, value in names.items() if np.asarray(value).dtype.kind == "U"]
            hint = f'; text stands in quotes, as in {texts[0]} == "{error.name}"' if texts else ""
            raise ValueError(f"has the unknown name {error.name}; known names: {known}{hint}") from None
        except FunctionNotDefined as error:
            raise ValueError(f"calls {error.func_name}, which no expression may; {self._allowed}") from None
        except OperatorNotDefined as error:
            raise ValueError(f"holds the operator {type(error.attr).__name__}; {self._allowed}") from None
        except FeatureNotAvailable:
            raise ValueError(
                f"holds more than arithmetic and comparisons ({_short(self.text)}); {self._allowed}"
            ) from None
        except _NoNumber as error:
            raise ValueError(f"comes to no number ({error.args[0]} in {_short(self.text)}); change it") from None
        except ZeroDivisionError:
            raise ValueError(f"divides by zero ({_short(self.text)}); change it or the parameters") from None
        except OverflowError:
            raise ValueError(f"is too large a number ({_short(self.text)}); change it or the parameters") from None
        except (TypeError, np.exceptions.DTypePromotionError) as error:
            raise ValueError(f"cannot be worked out ({error}); give each operator and function what it takes") from None
        except RecursionError:
            raise ValueError("is nested too deep; simplify it") from None
        finally:
            evaluator.let_go()


def _read_as(name: str) -> str:
    """As Python reads a name: the micro sign of keyboards, for one, as the Greek letter."""
    return name if name.isascii() else unicodedata.normalize("NFKC", name)


def _short(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:57]}..."


def _is_array(*values: Any) -> bool:
    return any(isinstance(value, np.ndarray) for value in values)


def _real_power(base: float, exponent: float) -> float:
    try:
        found = base**exponent
    except (ZeroDivisionError, OverflowError):
        return np.nan
    is_known = base == base and exponent == exponent  # NaN to the power of 0 is 1
    return found if is_known and isinstance(found, float) else np.nan


class Formula(Expression):
    """An expression of columns: with functions of angles and roots, too.

    >>> Formula("degrees(acos(half))").value({"half": 0.5})
    60.00000000000001
    """


class _NoNumber(Exception):
    """A function is not known of some numbers; its name says which."""


def _of_each(name: str, function: Callable[..., float]) -> Callable[..., Any]:
    """Return a function of numbers as one of arrays, too: each element by itself, as NumPy's may differ in the last
    digit. NaN where it is not known.
    """

    def of(*values: float) -> float:
        try:
            return function(*values)
        except (ValueError, OverflowError):
            return math.nan

    def of_all(*values: Any) -> Any:
        if not _is_array(*values):
            found = of(*values)
            if math.isnan(found):
                raise _NoNumber(name)
            return found
        columns = [array.tolist() for array in np.broadcast_arrays(*values)]
        return np.array([of(*row) for row in zip(*columns, strict=True)], dtype=np.float64)

    return of_all


def _least(*values: Any) -> Any:
    return reduce(np.minimum, values) if _is_array(*values) else min(*values)


def _greatest(*values: Any) -> Any:
    return reduce(np.maximum, values) if _is_array(*values) else max(*values)


_OPERATORS: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: np.logical_not,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
FUNCTIONS: dict[str, Callable[..., Any]] = {"abs": abs, "min": _least, "max": _greatest}
"""What expressions of scenes may call."""
_OF_ONE = (math.sqrt, math.sin, math.cos, math.tan, math.asin, math.acos, math.atan, math.degrees, math.radians)
_OF_TWO = (math.atan2, math.hypot)
_N_TAKEN = {"abs": 1, **{each.__name__: n for n, kind in ((1, _OF_ONE), (2, _OF_TWO)) for each in kind}}
Expression.functions = FUNCTIONS
Formula.functions = FUNCTIONS | {each.__name__: _of_each(each.__name__, each) for each in (*_OF_ONE, *_OF_TWO)}


class _Evaluator(SimpleEval):  # type: ignore[misc]  # it has no types
    def __init__(self, names: Mapping[str, Any], functions: Mapping[str, Callable[..., Any]]) -> None:
        own: dict[type, Callable[..., Any]] = {ast.Div: self._quotient, ast.Pow: self._power}
        super().__init__(operators={**_OPERATORS, **own}, functions=functions, names=names)
        self._unknown: Any = np.False_
        self.nodes = {
            ast.Name: self._eval_name,
            ast.Attribute: self._eval_attribute,
            ast.UnaryOp: self._eval_unaryop,
            ast.BinOp: self._eval_binop,
            ast.BoolOp: self._eval_boolop,
            ast.Compare: self._eval_compare,
            ast.Call: self._eval_call,
            ast.Constant: self._eval_constant,
        }

    def let_go(self) -> None:
        """Break the ring of this object and its own methods, which would keep all rows until Python looks for rings."""
        self.nodes.clear()
        self.operators.clear()

    def known(self, found: Any) -> Any:
        """Return what was found without the rows of which a part is an error: a comparison hides that it was NaN."""
        if not _is_array(found) or not np.any(self._unknown):
            return found
        return found & ~self._unknown if found.dtype == np.bool_ else np.where(self._unknown, np.nan, found)

    def _quotient(self, one: Any, other: Any) -> Any:
        """As Python, to which nothing divided by zero is a number."""
        if not _is_array(one, other):
            return one / other
        self._unknown = self._unknown | np.equal(other, 0.0)
        return np.where(np.equal(other, 0.0), np.nan, one / other)

    def _power(self, base: Any, exponent: Any) -> Any:
        """Python's power of each element: NumPy's may differ in the last digit."""
        if not _is_array(base, exponent):
            return base**exponent
        bases, exponents = np.broadcast_arrays(base, exponent)
        pairs = zip(bases.tolist(), exponents.tolist(), strict=True)
        found = np.array([_real_power(one, other) for one, other in pairs])
        self._unknown = self._unknown | (np.isnan(found) & ~np.isnan(bases) & ~np.isnan(exponents))
        return found

    @staticmethod
    def _eval_constant(node: ast.Constant) -> float | str:
        """Whole numbers as floats, too: no power of them fills the memory."""
        if isinstance(node.value, str):
            return node.value
        if isinstance(node.value, (int, float)) and not isinstance(node.value, bool):
            return float(node.value)
        raise FeatureNotAvailable("a constant that is neither a number nor text")

    def _eval_attribute(self, node: ast.Attribute) -> Any:
        """``tip.z`` is the name ``tip_z``; a name with dots, such as ``friction.coefficient``, is itself."""
        name = ast.unparse(node)
        for known in (name, name.replace(".", "_")):
            if known in self.names:
                return self.names[known]
        raise NameNotDefined(name, self.expr)

    def _eval_call(self, node: ast.Call) -> Any:
        if not isinstance(node.func, ast.Name) or node.func.id not in self.functions or node.keywords:
            raise FunctionNotDefined(ast.unparse(node.func), self.expr)
        name, values = node.func.id, [self._eval(argument) for argument in node.args]
        n_taken = _N_TAKEN.get(name)
        if len(values) < 2 if n_taken is None else len(values) != n_taken:
            raise TypeError(f"{name} of {len(values)}")
        found = self.functions[name](*values)
        if name in _N_TAKEN and name != "abs" and _is_array(found):
            self._unknown = self._unknown | (np.isnan(found) & ~np.logical_or.reduce([np.isnan(one) for one in values]))
        return found

    def _eval_boolop(self, node: ast.BoolOp) -> Any:
        join = np.logical_and if isinstance(node.op, ast.And) else np.logical_or
        return reduce(join, map(self._eval, node.values))

    def _eval_compare(self, node: ast.Compare) -> Any:
        terms = [self._eval(term) for term in (node.left, *node.comparators)]
        found = []
        for kind, one, other in zip(node.ops, terms, terms[1:], strict=False):
            if type(kind) not in self.operators:
                raise OperatorNotDefined(kind, self.expr)
            found.append(self.operators[type(kind)](one, other))
        return reduce(np.logical_and, found)
