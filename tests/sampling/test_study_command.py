"""``cagepose study`` as people call it: what it prints, its exit codes, Ctrl-C, full disks and missing extras."""

from __future__ import annotations

import csv
import errno
import json
import signal
import subprocess
import sys
import time
from importlib import util
from pathlib import Path
from typing import Any

import pytest

from cagepose import MissingExtraError, Study, StudyResults
from cagepose.cli.app import main
from cagepose.files import write
from cagepose.model.wording import percent
from cagepose.sampling import folder as folder_module
from our_studies import RAIL

STUDY = f"""\
scene: {RAIL}
vary:
  cage.pose.euler_zyx_deg[1]: {{uniform: [-0.4, 0.4]}}
  cage.pose.euler_zyx_deg[0]: {{uniform: [-0.4, 0.4]}}
sample: {{runs: 300}}
sensitivities: true
map: {{over: ["cage.pose.euler_zyx_deg[1]", "cage.pose.euler_zyx_deg[0]"], count: 8}}
"""

pytestmark = pytest.mark.usefixtures("small_designs")


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(STUDY, encoding="utf-8")
    return "study.yaml"


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    capsys.readouterr()
    code = main(["study", *arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_a_study_prints_what_its_page_says_and_show_says_it_again(
    study: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, err = answer(capsys, study, "--out", "out")
    assert code == 0
    assert err.splitlines()[-1].startswith("cagepose: 300 runs in ")
    numbers = json.loads(Path("out/report.json").read_text(encoding="utf-8"))
    share = numbers["yield"]["share"]
    assert f"yield {percent(share)}, between" in out
    assert "Sobol indices of accepted" in out
    assert "largest box of accepted runs: cage.pose.euler_zyx_deg[1]" in out
    n_beside = len(list(Path("out").glob("[!.]*.*"))) - len(["report.html", "study.yaml", "scene.yaml"])
    assert out.splitlines()[-1] == f"wrote {Path('out/report.html')} and {n_beside} files beside it"
    shown = answer(capsys, "show", "out")
    assert shown == (0, out[: out.index("wrote")], "")
    code, text, _ = answer(capsys, "show", "out", "--json")
    assert (code, json.loads(text)) == (0, numbers)
    rows_as_csv(capsys)
    for gone in (lambda: Path("out/report.json").unlink(), lambda: of_another_version(numbers)):
        gone()  # then it is written anew
        code, out_again, _ = answer(capsys, "show", "out")
        assert (code, out_again) == (0, out)
    assert answer(capsys, study, "--out", "out")[0] == 2
    assert answer(capsys, study, "--out", "out", "--resume")[0] == 0


@pytest.mark.usefixtures("no_pictures")
def test_a_condition_that_no_rest_meets_is_told(study: str, capsys: pytest.CaptureFixture[str]) -> None:
    """What the one method calls a rest the other one calls stable."""
    scene = Path("stepwise.yaml")
    scene.write_text(f"method: stepwise\n{RAIL.read_text(encoding='utf-8')}", encoding="utf-8")
    text = STUDY.replace(str(RAIL), scene.name) + "accept: verdict == 'rests'\n"
    Path(study).write_text(text, encoding="utf-8")
    code, out, _ = answer(capsys, study, "--out", "out")
    assert code == 0
    n_stable = json.loads(Path("out/report.json").read_text(encoding="utf-8"))["verdicts"]["stable"]["runs"]
    assert f"no run is good, though runs come to rest: {n_stable} as 'stable'; is accept right?" in out
    page = Path("out/report.html").read_text(encoding="utf-8")
    assert f"No run is good, though runs come to rest: {n_stable}\nas <code>stable</code>." in page


def of_another_version(numbers: dict[str, Any]) -> None:
    """What is left of a study when cagepose was renewed: other keys, it may be."""
    kept = {name: numbers[name] for name in ("yield", "runs")}
    Path("out/report.json").write_text(json.dumps({**kept, "version": "0.0.9"}), encoding="utf-8")


def rows_as_csv(capsys: pytest.CaptureFixture[str]) -> None:
    """All rows with all their digits; over our own file, and over nobody else's."""
    for _ in range(2):
        assert answer(capsys, "show", "out", "--csv", "rows.csv") == (0, "wrote rows.csv: 300 rows\n", "")
    with Path("rows.csv").open(encoding="utf-8", newline="") as stream:
        read = list(csv.DictReader(stream))
    for line, row in zip(read, StudyResults("out").table().to_pylist(), strict=True):
        assert list(line) == list(row)
        for name, value in row.items():
            if isinstance(value, bool) or value is None:
                assert line[name] == {None: "", True: "true", False: "false"}[value]
            else:
                assert type(value)(line[name]) == value  # to the last digit
    Path("mine.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    code, out, err = answer(capsys, "show", "out", "--csv", "mine.csv")
    assert (code, out) == (2, "")
    assert (
        err == "--csv mine.csv: holds something else than these columns as CSV; name another file, or remove it first\n"
    )
    assert answer(capsys, "show", "out", "--csv", "no/such.csv")[2].startswith("--csv no/such.csv: its folder does not")
    assert not list(Path().glob(".*.part"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("study.yaml",), "study needs --out FOLDER"),
        (("study.yaml", "other.yaml", "--out", "o"), "too many arguments: other.yaml"),
        (("show",), "study show needs the folder"),
        (("show", "out", "--resume"), "study show runs nothing"),
        (("study.yaml", "--out", "o", "--csv", "x.csv"), "--csv works with study show alone"),
        (("show", "out", "--csv", "x.csv", "--json"), "--csv prints no report; leave --json out"),
        (("study.yaml", "--out", "o", "--workers", "0"), "--workers is 0; give 1 or more"),
        (("none.yaml", "--out", "o"), "none.yaml: does not exist"),
        (("show", "none"), "none: holds no study"),
        (("study.yaml", "--out", "no/such"), "no/such: its folder does not exist; make the folder first"),
        (("study.yaml", "--out", "study.yaml"), "study.yaml: is not a folder"),
        (("study.yaml", "--out", "a\0b"), "is not a folder's name"),
    ],
)
@pytest.mark.usefixtures("study")
def test_what_cannot_be_done_is_said_in_one_line(
    capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], message: str
) -> None:
    code, out, err = answer(capsys, *arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert len(err.splitlines()) == 1


@pytest.mark.usefixtures("no_pictures")
@pytest.mark.parametrize(
    ("number", "told", "remedy"),
    [
        (errno.ENOSPC, "No space left on device", "make room"),
        (errno.EACCES, "Permission denied", "put that right"),
    ],
)
def test_what_cannot_be_written_is_a_clear_error_and_can_be_resumed(
    study: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, number: int, told: str, remedy: str
) -> None:
    def full(path: Any, content: bytes) -> None:
        if str(path).endswith(".parquet"):
            raise OSError(number, told)
        write.write_whole(path, content)

    with monkeypatch.context() as patch:
        patch.setattr(folder_module, "write_whole", full)
        code, _, err = answer(capsys, study, "--out", "out")
    assert code == 2
    assert err.splitlines()[-1] == f"out: cannot be written ({told}); {remedy} and add --resume"
    assert answer(capsys, "show", "out") == (2, "", "out: holds no rows yet; run the study with --resume\n")
    assert answer(capsys, study, "--out", "out", "--resume")[0] == 0
    assert len(StudyResults("out")) == 300


def test_ctrl_c_leaves_a_folder_to_go_on_with(study: str, tmp_path: Path) -> None:
    """A real process and a real signal, sent when two parts are there."""
    Path(study).write_text(STUDY.replace("runs: 300", "runs: 20000"), encoding="utf-8")
    code = (
        "import signal, sys\nfrom cagepose.cli.app import main\nfrom cagepose.sampling import runner\n"
        "runner.ROWS_OF_A_BATCH = 256\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "sys.exit(main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", code, "study", study, "--out", "out", "--workers", "1"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        while len(list(tmp_path.glob("out/parts/rows*"))) < 2:
            time.sleep(0.02)
            assert process.poll() is None
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=20.0)
    assert process.returncode == 130
    assert "go on with: cagepose study study.yaml --out out --resume" in err
    assert "Traceback" not in err
    done = len(StudyResults(tmp_path / "out"))
    assert 512 <= done < 20000
    assert done % 256 == 0


def test_a_missing_extra_is_named_with_its_install_line(monkeypatch: pytest.MonkeyPatch) -> None:
    find = util.find_spec
    monkeypatch.setattr("cagepose.files.extra.find_spec", lambda name: None if name == "pyarrow" else find(name))
    missing = r"studies need pyarrow.*pip install 'cagepose\[study\]'"
    with pytest.raises(MissingExtraError, match=missing):
        StudyResults("out")
    vary = {"cage.pose.euler_zyx_deg[1]": {"uniform": [0, 1]}}
    with pytest.raises(MissingExtraError, match=missing):
        Study(RAIL, vary, {"runs": 1})
    monkeypatch.setattr("cagepose.files.extra.find_spec", lambda name: None if name == "distributed" else find(name))
    with pytest.raises(MissingExtraError, match=r"many machines need Dask.*pip install 'cagepose\[dask\]'"):
        Study(RAIL, vary, {"runs": 1}).run("out", dask="tcp://localhost:1")


def test_the_classes_can_be_imported_without_the_extra() -> None:
    """``from cagepose import *`` asks for all names, and most users have no use for studies."""
    code = (
        "import sys\nfor name in ('scipy', 'pyarrow', 'SALib', 'distributed', 'jinja2', 'matplotlib', 'pandas'):\n"
        "    sys.modules[name] = None\nfrom cagepose import *\nprint(Study.__name__, StudyResults.__name__)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "Study StudyResults\n"
