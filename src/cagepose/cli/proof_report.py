"""What ``cagepose check`` says of a saved run: are its proofs right, and what do they show?"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cagepose.runs.run import Run
    from cagepose.studies.certificate_check import CertificateCheck
    from cagepose.studies.drive_check import DriveCheck


def check_saved_run(path: str) -> int:
    """Check the certificates of a saved run, and print what each phase's shows; return 1 if one is wrong."""
    from cagepose.errors import CertificateError, printable
    from cagepose.files.run_file import load_certificates, load_run
    from cagepose.studies.certificate_check import check_certificate

    run, certificates, is_wrong = load_run(path), load_certificates(path), False
    sys.stdout.write(printable(f"{run.scene.name}: saved run, method {run.method}") + "\n")
    for number, (phase, found) in enumerate(zip(run.phases, certificates, strict=False)):
        if found is None:
            lines = ["it has no certificate: nothing is proven"]
        else:
            try:
                lines = list(_lines(run, number, check_certificate(found, run, number)))
            except CertificateError as error:
                is_wrong, lines = True, [f"the certificate is wrong: {error}"]
        sys.stdout.write(printable(f"{phase.name}: {phase.verdict}") + "\n")
        sys.stdout.write("".join(printable(f"  {line}") + "\n" for line in lines))
    return 1 if is_wrong else 0


def _lines(run: Run, number: int, checked: CertificateCheck) -> Iterator[str]:
    from cagepose.model.wording import counted

    left = f"contact forces balance the load (residual {checked.residual:.1e})"
    if checked.uniqueness == "strong":
        cases = counted((checked.n_leaves, "case", "cases"))
        yield f"rest is proven: {left}, and no motion can begin ({cases}, at most {checked.speed:.1e} loads)"
    elif checked.uniqueness is not None:
        other = "a motion is possible too" if checked.uniqueness == "weak" else "another motion is not ruled out"
        yield f"rest is possible: {left}; {other}"
    if checked.drive is not None:
        yield from _drive_lines(run, number, checked.drive)


def _drive_lines(run: Run, number: int, drive: DriveCheck) -> Iterator[str]:
    from cagepose.model.wording import counted, few

    places, margin = counted((drive.n_places, "place", "places")), drive.margin
    if drive.could_jam:
        shares = few([f"{100.0 * share:.6g} %" for share in drive.could_jam])
        yield f"drive: could jam at {shares} of the way ({places} checked)"
    if len(drive.could_jam) < drive.n_places:
        where = "at the others" if drive.could_jam else f"at any of {places}"
        sure = "nothing touches there" if margin is None else f"margin {max(margin, 0.0):.1e} of the drift"
        yield f"drive: cannot jam {where}, with these contacts, at this friction and below ({sure})"
    yield "drive: only these places are proven, not the way between them"
    if drive.stopped == "blocked":
        free = counted((drive.n_free, "freedom is", "freedoms are")) or "no freedom is"
        yield f"blocked: normal forces resist any drive force; {free} left, to second order not checked"
    elif drive.stopped == "jams":
        cases = counted((drive.n_leaves, "case", "cases"))
        yield f"jams: in none of {cases} can the drive go on; without friction it could"
    elif run.phases[number].verdict in ("blocked", "jams"):
        yield f"{run.phases[number].verdict}: the file has no proof of it"
