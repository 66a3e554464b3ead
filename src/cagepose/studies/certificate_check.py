"""Is a certificate of rest right? `check_certificate`, in NumPy, with nothing of the search that made it.

Contacts, load and metric are those of the scene at the pose, found anew; the certificate is believed in nothing but
where to look. Where shapes touch that are not boxes and points, the kernels say, as `contact_problem` tells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import get_args

from cagepose.errors import CertificateError
from cagepose.model.checks import expect
from cagepose.runs.proof import Uniqueness
from cagepose.runs.run import Run
from cagepose.studies.certificate import Certificate, OtherOnset
from cagepose.studies.choice_check import CheckedChoice
from cagepose.studies.contact_problem import ContactProblem, contact_problem
from cagepose.studies.contacts_check import check_choice, check_choices, check_contacts, known_contacts
from cagepose.studies.drive_check import DriveCheck, check_drive


@dataclass(frozen=True)
class CertificateCheck:
    """What a certificate that is right shows.

    Attributes
    ----------
    uniqueness
        As in `Certificate`.
    residual
        What its forces leave of the load, at most; zero is a balance.
    n_leaves
        How many cases its trees tell apart.
    speed
        In loads, scaled as in (5.3). "strong": no motion is faster with contact forces that add up to one load, and
        with f loads none faster than the root of f times as much. "weak": that of the other onset. Else zero.
    drive
        What it shows of the drive of the phase; None: nothing.
    """

    uniqueness: Uniqueness | None
    residual: float
    n_leaves: int
    speed: float
    drive: DriveCheck | None = None


def check_certificate(certificate: Certificate | None, run: Run, phase: int = -1) -> CertificateCheck:
    """Check a certificate against a run's scene and the pose at the end of a phase.

    Checked are: contacts, friction and choices of faces are those of the scene; forces inside their cones balance the
    load; the nodes of each tree cover all cases of those that they divide; and the twist of each leaf proves, by
    (5.20), that no motion begins there. Or, of another onset, Coulomb's law (5.7). What is said of a drive is checked
    in the same way, at each place of its curve; nothing is said of what lies between them.

    Parameters
    ----------
    certificate
        From `certificate` or `load_certificates`; None proves nothing.
    run
        Of which the scene, the method's friction, and the phase's pose count.
    phase
        Its number, from 0; the last one.

    Raises
    ------
    CertificateError
        It proves nothing: says where, what was found, and what was to be there.
    IndexError
        The run has no such phase.
    """
    if certificate is None:
        raise CertificateError("there is none: cagepose.certificate says why, such as an object that moves")
    expect(certificate, Certificate, "certificate")
    expect(run, Run, "run")
    number = range(len(run.phases))[phase]
    drive = None if certificate.drive is None else check_drive(certificate.drive, run, number)
    if certificate.uniqueness is None and drive is not None:
        return CertificateCheck(None, 0.0, 0, 0.0, drive)
    if certificate.uniqueness not in get_args(Uniqueness):
        raise CertificateError(
            f"uniqueness is {certificate.uniqueness!r}; it is one of {', '.join(get_args(Uniqueness))}"
        )
    problem = contact_problem(run, number)
    places = check_contacts(certificate, problem, run.scene.size_m)
    _check_choices(certificate, places, problem)
    residual, n_leaves, speed = 0.0, 0, 0.0
    for number, choice in enumerate(certificate.choices):
        checked = CheckedChoice(problem, [places[contact] for contact in choice.contacts], f"choices[{number}]")
        residual = max(residual, checked.balance(choice))
        if certificate.uniqueness == "strong":
            if choice.tree is None:
                raise CertificateError(f"choices[{number}] has no tree, so another onset is not ruled out")
            speed = max(speed, checked.speed_limit(choice.tree))
            n_leaves += len(choice.tree.leaves())
    if certificate.uniqueness == "weak":
        onset = certificate.onset
        if onset is None:
            raise CertificateError("onset is missing, and rest is said to be one of several")
        speed = CheckedChoice(problem, _taken(onset, places), "onset").speed(onset)
    return CertificateCheck(certificate.uniqueness, residual, n_leaves, speed, drive)


def _check_choices(certificate: Certificate, places: list[int], problem: ContactProblem) -> None:
    """Each choice of one face of each group must be there."""
    check_choices([choice.contacts for choice in certificate.choices], places, problem, "")
    if certificate.onset is not None:
        check_choice(frozenset(_taken(certificate.onset, places)), problem, "")


def _taken(onset: OtherOnset, places: list[int]) -> list[int]:
    return [places[contact] for contact in known_contacts(onset.contacts, len(places), "onset.contacts")]
