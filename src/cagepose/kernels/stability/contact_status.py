"""What a contact does to second order: `ContactStatus`."""

from __future__ import annotations


class ContactStatus:
    """What a contact does to second order; a record.

    Attributes
    ----------
    is_equality
        Whether it may carry in some balance, so that it can never open without work.
    is_implied
        Whether the others that may open keep it from closing.
    is_shared
        Whether its normal force could be another.
    opens
        Whether a free twist is known that opens it and closes no other.
    """

    is_equality: bool
    is_implied: bool
    is_shared: bool
    opens: bool
