"""What tests of the exchange share."""

from __future__ import annotations

import json

import pytest

from cagepose.errors import Problem, SceneError
from cagepose.exchange import compile_model


@pytest.fixture
def here(monkeypatch):
    """Compile in this process, which spares a start of Python."""

    def ask(_module, given, _seconds, _library):
        try:
            return json.dumps(compile_model.compiled_here(json.loads(given))).encode()
        except ValueError as error:
            raise SceneError([Problem((), str(error))]) from None

    monkeypatch.setattr(compile_model, "ask", ask)
