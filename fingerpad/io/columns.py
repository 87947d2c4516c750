"""Units and meanings of the columns of tables: one list for every file that names them."""

from typing import NamedTuple


class Column(NamedTuple):
    """Unit and meaning of a column."""

    unit: str
    """In SI; 1 for a number without a unit."""
    meaning: str


FIELDS = {
    "displacement": Column("m", "displacement, plane"),
    "stress": Column("Pa", "Cauchy stress, 3 x 3, row by row"),
    "sed": Column("J/m^3", "strain energy density per reference volume"),
}
"""Variables of the files for ParaView, each in the file of its name."""

STEPS = {
    "step": Column("1", "number of the accepted step"),
    "load": Column("1", "name of the load"),
    "load_number": Column("1", "number of the load, from 1"),
    "f_ext": Column("N/m", "external normal force on the bone per metre of finger"),
    "voltage": Column("V", "instantaneous voltage"),
    "bone_x": Column("m", "horizontal position of the bone"),
    "bone_height": Column("m", "change of the bone's height from the unloaded position"),
    "f_t": Column("N/m", "friction force on the bone per metre of finger"),
    "mu_app": Column("1", "apparent friction coefficient f_t / f_ext; none where no force presses"),
    "f_contact": Column("N/m", "contact force of the screen per metre of finger"),
    "f_electrostatic": Column("N/m", "electrostatic attraction per metre of finger"),
    "ridges_in_contact": Column("1", "number of ridges in contact"),
    "contact_length": Column("m", "sum of the lengths in contact"),
    "slipping": Column("1", "part of the points in contact that slip"),
    "all_slip": Column("1", "whether all points in contact slip one way"),
    "slip_began": Column("1", "first step of the full slip that the state belongs to; 0 without full slip"),
    "slip_held": Column("1", "whether this full slip was held over a further 0.2 mm"),
    "penetration": Column("m", "largest depth of the skin in the screen"),
    "imbalance": Column(
        "1", "largest nodal force left, relative to the largest f_ext of all loads, or to 1 N/m without one"
    ),
    "floor": Column("1", "residual at which the last solve ended at roundoff, on the same scale; 0 if converged"),
    "stored": Column("J/m", "stored energy per metre of finger"),
    "dissipation": Column("J/m", "energy dissipated by friction in the step per metre of finger"),
    "energy_released": Column(
        "J/m",
        "energy released by a jump per metre of finger; in a step without a jump the error of the work's quadrature",
    ),
    "released_error": Column("J/m", "error of the energy released by a jump"),
    "newton_iterations": Column("1", "Newton iterations of the step"),
    "factorisations": Column("1", "factorisations of the step"),
    "coupling_iterations": Column("1", "coupling iterations of the step"),
    "cutbacks": Column("1", "number of times that the step was cut"),
    "jump": Column("1", "whether skin or an air gap moved without the loads"),
    "mesh_contact": Column("m", "contact size of the mesh"),
    "processor_seconds": Column("s", "processor time of all ranks since the start of the run"),
    "time": Column("s", "time since the start of the first load over time"),
}
RIDGES = {
    "contact_length": Column("m", "length of the ridge in contact"),
    "f_contact": Column("N/m", "contact force of the ridge per metre of finger"),
    "f_friction": Column("N/m", "friction force on the ridge per metre of finger, positive towards x > 0"),
    "f_electrostatic": Column("N/m", "attraction of the ridge per metre of finger"),
    "p_c": Column("Pa", "mean contact pressure of the ridge over its length in contact"),
    "d_eq": Column("m", "equivalent air gap of the ridge"),
    "state": Column("1", "remark on the place of the ridge on the closure; mostly empty"),
}
RECEPTORS = {
    "merkel_sed": Column("J/m^3", "strain energy density at the Merkel site of the ridge, per reference volume"),
    "meissner_left": Column("J/m^3", "strain energy density at the left Meissner site of the ridge"),
    "meissner_right": Column("J/m^3", "strain energy density at the right Meissner site of the ridge"),
}
SKIN = {
    "x": Column("m", "current abscissa of the skin"),
    "y": Column("m", "current height of the skin above the screen"),
    "p_n": Column("Pa", "contact pressure per current area"),
    "t_t": Column("Pa", "shear traction on the skin per current area, positive towards x > 0"),
    "p_el": Column("Pa", "electrostatic pressure per current area"),
}
SPECTRUM = {
    "frequency": Column("Hz", "frequency of the amplitude of friction"),
    "f_t_amplitude": Column("N/m", "amplitude of the friction force at the frequency per metre of finger"),
}
STATES = {name: STEPS[name] for name in ("step", "f_ext", "voltage", "bone_x", "bone_height", "f_t", "mu_app")} | {
    name: STEPS[name] for name in ("f_contact", "f_electrostatic", "ridges_in_contact", "contact_length")
}
FINGER = {
    "f_ext": Column("N", "external normal force on the whole finger"),
    "f_t": Column("N", "friction force on the whole finger"),
    "mu_app": Column("1", "apparent friction coefficient of the whole finger"),
    "f_electrostatic": Column("N", "electrostatic attraction of the whole finger"),
    "gross_area": Column("m^2", "area between the outermost touching ridges of the slices"),
    "contact_area": Column("m^2", "area in contact, of the ridges"),
    "indentation": Column("m", "lowering of the bone at z = 0"),
    "effective_width": Column(
        "m", "external force of the finger over that of its centre, the slice that touches first"
    ),
}
SLICES = {
    "z": Column("m", "place of the slice along the finger"),
    "thickness": Column("m", "thickness of the slice, its weight in the sum"),
    "indentation": Column("m", "indentation of the slice"),
    "f_ext": Column("N/m", "external normal force of the slice per metre of finger"),
    "f_t": Column("N/m", "friction force of the slice per metre of finger"),
    "f_electrostatic": Column("N/m", "electrostatic attraction of the slice per metre of finger"),
    "contact_length": Column("m", "length of the slice in contact, of the ridges"),
    "gross_width": Column("m", "width between the outermost touching ridges of the slice"),
    "pressure": Column("Pa", "mean contact pressure of the slice over its length in contact"),
}
STABILITY = {
    "stable": Column("1", "whether the state is stable: 1 yes, 0 no, -1 not examined"),
    "lambda_min": Column("Pa/m", "least eigenvalue of the tangent at frozen air gaps"),
    "gain": Column("1", "largest gain of a ridge's loop over the two scales"),
}
CHANGES = {"error": "estimated discretisation error", "penalty": "estimated change for a rigid screen"}
