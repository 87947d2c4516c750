"""The names of fingerpad: read by type checkers and editors, and by the package, which imports each when it is used."""

import geometry as geometry
from fingerpad import afferents as afferents
from fingerpad.measurements.calibrate import Calibration as Calibration
from fingerpad.measurements.calibrate import calibrate as calibrate
from fingerpad.measurements.compare import compare as compare
from fingerpad.model.body import Body as Body
from fingerpad.reduced.press import Press as Press
from fingerpad.results.quantities import Output as Output
from fingerpad.results.result import Result as Result
from fingerpad.runs.drive import Drive as Drive
from fingerpad.runs.drive import drive as drive
from fingerpad.runs.inverse import Solution as Solution
from fingerpad.runs.inverse import solve as solve
from fingerpad.runs.press import press as press
from fingerpad.runs.solve import run as run
from fingerpad.runs.sweep import sweep as sweep
from fingerpad.runs.sweep_results import Sweep as Sweep
from fingerpad.scene import Scene as Scene
from fingerpad.scene import SceneError as SceneError
from fingerpad.scene.people import people as people
from variational.attraction.adhesion import Adhesion as Adhesion
from variational.attraction.adhesion import Dugdale as Dugdale
from variational.attraction.circuit import GapCircuit as GapCircuit
from variational.attraction.dielectric import ColeCole as ColeCole
from variational.attraction.dielectric import TabledTissue as TabledTissue
from variational.contact.aging import Growing as Growing
from variational.contact.aging import GrowingShear as GrowingShear
from variational.contact.aging import Occlusion as Occlusion
from variational.contact.aging import Speed as Speed
from variational.contact.augmented import AugmentedLagrangian as AugmentedLagrangian
from variational.contact.formulation import Formulation as Formulation
from variational.contact.friction import Coulomb as Coulomb
from variational.contact.friction import Derjaguin as Derjaguin
from variational.contact.friction import Friction as Friction
from variational.contact.nitsche import Nitsche as Nitsche
from variational.contact.penalty import Penalty as Penalty
from variational.materials.material import Material as Material
from variational.materials.neo_hooke import NeoHooke as NeoHooke
from variational.materials.ogden import Ogden as Ogden
from variational.materials.qlv import QLV as QLV
from variational.materials.saint_venant import SaintVenant as SaintVenant
from variational.materials.viscoelastic import Viscoelastic as Viscoelastic
from variational.roughness.bam import BearingArea as BearingArea
from variational.roughness.boundary_elements import BoundaryElements as BoundaryElements
from variational.roughness.closure import AirGap as AirGap
from variational.roughness.closure import Closure as Closure
from variational.roughness.persson import Persson as Persson
from variational.state import ContactState as ContactState

__version__: str
