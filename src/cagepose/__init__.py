"""How much play a loosely held part has, where it comes to rest, through which contacts, and why.

    import cagepose
    run = cagepose.run(cagepose.load_scene("scene.yaml"))
    print(run.verdict, run.pose.position_m)

Everything is in SI units and radians; scene files and ``--json`` documents have their own units. Names are loaded when
they are first used, so that ``cagepose --help`` need not wait for NumPy.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cagepose.errors import CageposeError as CageposeError
    from cagepose.errors import CertificateError as CertificateError
    from cagepose.errors import KernelsError as KernelsError
    from cagepose.errors import MissingExtraError as MissingExtraError
    from cagepose.errors import Problem as Problem
    from cagepose.errors import RunFileError as RunFileError
    from cagepose.errors import SceneError as SceneError
    from cagepose.errors import SceneFileError as SceneFileError
    from cagepose.errors import StudyFolderError as StudyFolderError
    from cagepose.files.run_file import load_certificates as load_certificates
    from cagepose.files.run_file import load_run as load_run
    from cagepose.files.run_file import save_run as save_run
    from cagepose.files.saved_scene import save_scene as save_scene
    from cagepose.files.scene_file import load_scene as load_scene
    from cagepose.model.box import Box as Box
    from cagepose.model.cage import Cage as Cage
    from cagepose.model.cage_body import CageBody as CageBody
    from cagepose.model.drive import Drive as Drive
    from cagepose.model.facets import Facets as Facets
    from cagepose.model.hole import Chamfer as Chamfer
    from cagepose.model.hole import Hole as Hole
    from cagepose.model.load import Force as Force
    from cagepose.model.load import Load as Load
    from cagepose.model.load import Moment as Moment
    from cagepose.model.parts import Object as Object
    from cagepose.model.pose import Pose as Pose
    from cagepose.model.press import Press as Press
    from cagepose.model.scene import Adjustable as Adjustable
    from cagepose.model.scene import Scene as Scene
    from cagepose.model.shapes import Capsule as Capsule
    from cagepose.model.shapes import Cone as Cone
    from cagepose.model.shapes import Convex as Convex
    from cagepose.model.shapes import Cylinder as Cylinder
    from cagepose.model.shapes import Disc as Disc
    from cagepose.model.shapes import Shape as Shape
    from cagepose.model.shapes import Sphere as Sphere
    from cagepose.model.spring import Spring as Spring
    from cagepose.model.tolerances import Tolerances as Tolerances
    from cagepose.questions.cage_rests import CageRest as CageRest
    from cagepose.questions.cage_rests import CageRests as CageRests
    from cagepose.questions.cage_rests import cage_rests as cage_rests
    from cagepose.questions.escape import EscapeEnergy as EscapeEnergy
    from cagepose.questions.escape import escape_energy as escape_energy
    from cagepose.questions.friction import FrictionLimits as FrictionLimits
    from cagepose.questions.friction import friction_limits as friction_limits
    from cagepose.questions.gap import CriticalGap as CriticalGap
    from cagepose.questions.gap import critical_gap as critical_gap
    from cagepose.questions.jam import Jam as Jam
    from cagepose.questions.jam import jam as jam
    from cagepose.questions.no_motion import NoMotion as NoMotion
    from cagepose.questions.resting import RestingPose as RestingPose
    from cagepose.questions.resting import RestingPoses as RestingPoses
    from cagepose.questions.resting import resting_poses as resting_poses
    from cagepose.questions.tipping import LiftOff as LiftOff
    from cagepose.questions.tipping import Loss as Loss
    from cagepose.questions.tipping import Tipping as Tipping
    from cagepose.questions.tipping import tipping as tipping
    from cagepose.questions.unanswered import Unanswered as Unanswered
    from cagepose.runs.critical import with_critical_friction as with_critical_friction
    from cagepose.runs.many import Runs as Runs
    from cagepose.runs.many import run_many as run_many
    from cagepose.runs.proof import FreeMotion as FreeMotion
    from cagepose.runs.proof import Proof as Proof
    from cagepose.runs.run import Contact as Contact
    from cagepose.runs.run import Event as Event
    from cagepose.runs.run import Frame as Frame
    from cagepose.runs.run import Motion as Motion
    from cagepose.runs.run import PhaseRun as PhaseRun
    from cagepose.runs.run import Run as Run
    from cagepose.runs.solve import run as run
    from cagepose.runs.variation import Variation as Variation
    from cagepose.sampling.design import Design as Design
    from cagepose.sampling.design_results import DesignResults as DesignResults
    from cagepose.sampling.results import StudyResults as StudyResults
    from cagepose.sampling.study import Study as Study
    from cagepose.studies.certificate import Certificate as Certificate
    from cagepose.studies.certificate import ChosenFaces as ChosenFaces
    from cagepose.studies.certificate import OtherOnset as OtherOnset
    from cagepose.studies.certificate_check import CertificateCheck as CertificateCheck
    from cagepose.studies.certificate_check import check_certificate as check_certificate
    from cagepose.studies.certify import certificate as certificate
    from cagepose.studies.comparison import Comparison as Comparison
    from cagepose.studies.comparison import Parting as Parting
    from cagepose.studies.comparison import Variant as Variant
    from cagepose.studies.comparison import compare as compare
    from cagepose.studies.drive_check import DriveCheck as DriveCheck
    from cagepose.studies.drive_proof import DrivenPlace as DrivenPlace
    from cagepose.studies.drive_proof import DriveProof as DriveProof
    from cagepose.studies.drive_proof import JamChoice as JamChoice
    from cagepose.studies.drive_proof import StopChoice as StopChoice
    from cagepose.studies.insertion import insertion as insertion
    from cagepose.studies.insertion_result import Insertion as Insertion
    from cagepose.studies.margin import ContactMargin as ContactMargin
    from cagepose.studies.margin import Margin as Margin
    from cagepose.studies.margin import margin as margin
    from cagepose.studies.misalignment import Misalignment as Misalignment
    from cagepose.studies.misalignment import MisalignmentEnd as MisalignmentEnd
    from cagepose.studies.mode_tree import ModeTree as ModeTree
    from cagepose.studies.play import play as play
    from cagepose.studies.play_result import Play as Play
    from cagepose.studies.press_limits import press_limits as press_limits
    from cagepose.studies.touched_faces import ContactFace as ContactFace

    __version__: str

_HOMES = {
    "cagepose.errors": (
        "CageposeError",
        "CertificateError",
        "KernelsError",
        "MissingExtraError",
        "Problem",
        "RunFileError",
        "SceneError",
        "SceneFileError",
        "StudyFolderError",
    ),
    "cagepose.model.box": ("Box",),
    "cagepose.model.cage": ("Cage",),
    "cagepose.model.cage_body": ("CageBody",),
    "cagepose.model.drive": ("Drive",),
    "cagepose.model.hole": ("Chamfer", "Hole"),
    "cagepose.model.load": ("Force", "Load", "Moment"),
    "cagepose.model.parts": ("Object",),
    "cagepose.model.pose": ("Pose",),
    "cagepose.model.press": ("Press",),
    "cagepose.model.scene": ("Adjustable", "Scene"),
    "cagepose.model.facets": ("Facets",),
    "cagepose.model.shapes": ("Capsule", "Cone", "Convex", "Cylinder", "Disc", "Shape", "Sphere"),
    "cagepose.model.spring": ("Spring",),
    "cagepose.model.tolerances": ("Tolerances",),
    "cagepose.questions.cage_rests": ("CageRest", "CageRests", "cage_rests"),
    "cagepose.questions.escape": ("EscapeEnergy", "escape_energy"),
    "cagepose.questions.friction": ("FrictionLimits", "friction_limits"),
    "cagepose.questions.jam": ("Jam", "jam"),
    "cagepose.questions.gap": ("CriticalGap", "critical_gap"),
    "cagepose.questions.no_motion": ("NoMotion",),
    "cagepose.questions.tipping": ("LiftOff", "Loss", "Tipping", "tipping"),
    "cagepose.questions.resting": ("RestingPose", "RestingPoses", "resting_poses"),
    "cagepose.questions.unanswered": ("Unanswered",),
    "cagepose.runs.critical": ("with_critical_friction",),
    "cagepose.runs.many": ("Runs", "run_many"),
    "cagepose.runs.proof": ("FreeMotion", "Proof"),
    "cagepose.runs.run": ("Contact", "Event", "Frame", "Motion", "PhaseRun", "Run"),
    "cagepose.runs.solve": ("run",),
    "cagepose.runs.variation": ("Variation",),
    "cagepose.sampling.design": ("Design",),
    "cagepose.sampling.design_results": ("DesignResults",),
    "cagepose.sampling.results": ("StudyResults",),
    "cagepose.sampling.study": ("Study",),
    "cagepose.studies.certificate": ("Certificate", "ChosenFaces", "OtherOnset"),
    "cagepose.studies.certificate_check": ("CertificateCheck", "check_certificate"),
    "cagepose.studies.certify": ("certificate",),
    "cagepose.studies.comparison": ("Comparison", "Parting", "Variant", "compare"),
    "cagepose.studies.drive_check": ("DriveCheck",),
    "cagepose.studies.drive_proof": ("DrivenPlace", "DriveProof", "JamChoice", "StopChoice"),
    "cagepose.studies.insertion": ("insertion",),
    "cagepose.studies.insertion_result": ("Insertion",),
    "cagepose.studies.margin": ("ContactMargin", "Margin", "margin"),
    "cagepose.studies.misalignment": ("Misalignment", "MisalignmentEnd"),
    "cagepose.studies.mode_tree": ("ModeTree",),
    "cagepose.studies.play": ("play",),
    "cagepose.studies.play_result": ("Play",),
    "cagepose.studies.press_limits": ("press_limits",),
    "cagepose.studies.touched_faces": ("ContactFace",),
    "cagepose.files.run_file": ("load_certificates", "load_run", "save_run"),
    "cagepose.files.saved_scene": ("save_scene",),
    "cagepose.files.scene_file": ("load_scene",),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [
    "Adjustable",
    "Box",
    "Cage",
    "CageBody",
    "CageRest",
    "CageRests",
    "CageposeError",
    "Capsule",
    "Certificate",
    "CertificateCheck",
    "CertificateError",
    "Chamfer",
    "ChosenFaces",
    "Comparison",
    "Cone",
    "Contact",
    "ContactFace",
    "ContactMargin",
    "Convex",
    "CriticalGap",
    "Cylinder",
    "Design",
    "DesignResults",
    "Disc",
    "Drive",
    "DriveCheck",
    "DriveProof",
    "DrivenPlace",
    "Facets",
    "EscapeEnergy",
    "Event",
    "Force",
    "Frame",
    "FreeMotion",
    "FrictionLimits",
    "Hole",
    "Insertion",
    "Jam",
    "JamChoice",
    "KernelsError",
    "LiftOff",
    "Load",
    "Loss",
    "Margin",
    "Misalignment",
    "MisalignmentEnd",
    "MissingExtraError",
    "ModeTree",
    "Moment",
    "Motion",
    "NoMotion",
    "Object",
    "OtherOnset",
    "Parting",
    "PhaseRun",
    "Play",
    "Pose",
    "Press",
    "Problem",
    "Proof",
    "RestingPose",
    "RestingPoses",
    "Run",
    "RunFileError",
    "Runs",
    "Scene",
    "SceneError",
    "SceneFileError",
    "Shape",
    "Sphere",
    "Spring",
    "StopChoice",
    "Study",
    "StudyFolderError",
    "StudyResults",
    "Tipping",
    "Tolerances",
    "Unanswered",
    "Variant",
    "Variation",
    "__version__",
    "cage_rests",
    "certificate",
    "check_certificate",
    "compare",
    "critical_gap",
    "escape_energy",
    "friction_limits",
    "insertion",
    "jam",
    "load_certificates",
    "load_run",
    "load_scene",
    "margin",
    "play",
    "press_limits",
    "resting_poses",
    "run",
    "run_many",
    "save_run",
    "save_scene",
    "tipping",
    "with_critical_friction",
]


def __getattr__(name: str) -> object:
    if name == "__version__":
        value: object = _version()
    elif name in _HOME:
        value = getattr(import_module(_HOME[name]), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version  # 20 ms, needed by --version alone

    try:
        return version("cagepose")
    except PackageNotFoundError:  # run from a source tree that was never installed
        return "0+unknown"
