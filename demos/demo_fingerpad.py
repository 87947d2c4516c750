# # Press, charge, slide
#
# A rigid bone presses a layered, ridged fingerpad on a rigid screen with a prescribed force per length, the
# voltage is switched on, and the bone slides sideways until every ridge slips (Forsbach, Heß and Papangelo 2023,
# doi 10.3389/fmech.2022.1074393). The macroscale is plane strain at finite strain with Coulomb friction and
# electrostatic attraction on the deformed gap; the roughness on each ridge enters through the equivalent air gap
# of a bearing area model.
#
#     python3 demos/demo_fingerpad.py [--scene scene.toml] [--f-ext 75] [--voltage 200] [--contact-size 5e-6]
#                                     [--friction 0.25] [--out results] [-fingerpad_snes_monitor …]
#     mpirun -n 2 python3 demos/demo_fingerpad.py …
#
# The folder of results holds `steps.csv`, `ridges.csv`, `receptors.csv`, `coupling.csv`, `summary.json`,
# `run.log`, pictures, and `displacement.bp`, `stress.bp`, `sed.bp` for ParaView.

import argparse
import sys

from fingerpad.command import add_arguments, command_line
from fingerpad.entry import MPI, start
from fingerpad.scene import SceneError


def main(comm: MPI.Comm, argv: list[str] | None = None) -> int:
    """Run a scene; return the exit code."""
    parser = argparse.ArgumentParser(description="Press, charge and slide a fingerpad.", add_help=True)
    add_arguments(parser)
    scene, args, petsc = command_line(parser, argv, quiet=comm.rank != 0)
    start(petsc)

    # PETSc has its options from here on.
    from fingerpad.full import exit_code, run
    from variational.friction import CONE_ROUNDOFF

    try:
        answer = run(scene, args.out, comm)
        result = answer.to_dict()
    except SceneError as error:
        if comm.rank == 0:
            print(f"fingerpad: {error}", file=sys.stderr)
        return 2

    # What must hold in every run, for the last full slip: the bone's load is what the screen bears less the
    # attraction, and the friction is mu_0 times the contact force. Bone and screen are compared by sums of nodal
    # forces, of which the solves' tolerance leaves `force_error`; points count as slipping within roundoff of the cone.
    if result["full_slip"]:
        balance = result["slip_f_contact"] - result["slip_f_electrostatic"] - result["slip_f_ext"]
        assert abs(balance) <= result["force_error"], balance
        law = scene.friction_law()
        cone = 0.0 if law is None else law.resultant(result["slip_f_contact"], result["slip_contact_length"])
        assert abs(abs(result["slip_f_t"]) - cone) <= result["force_error"] + CONE_ROUNDOFF * cone, result["slip_f_t"]
    return exit_code(answer)


if __name__ == "__main__":
    sys.exit(main(MPI.COMM_WORLD))
