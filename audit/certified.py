"""Has each rest a certificate, and is it right? Its checker finds contacts, load and metric anew, in NumPy.

It shares no code with the search that found the rest; and a search that is made again from the pose says what the run
said, or more: where the run left it open, rounding may decide.
"""

from __future__ import annotations

from audit.case import Answer
from cagepose import CertificateError, Run, certificate, check_certificate


def certified(run: Run) -> Answer:
    """Where a certificate is to be had, it is right and says what the proof says; a rest that moves has none."""
    found, asked = [], False
    for number, phase in enumerate(run.phases):
        proof = certificate(run, number)
        if proof is None:
            continue  # it moves, or is held to second order
        asked = True
        if phase.proof.uniqueness not in (proof.uniqueness, "not shown"):
            found.append(f"{phase.name}: {phase.proof.uniqueness}, and {proof.uniqueness} when it is asked again")
        try:
            check_certificate(proof, run, number)
        except CertificateError as error:
            found.append(f"{phase.name}: {error}")
    return found if asked else None
