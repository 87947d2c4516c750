r"""The force that pulls an adhering finger off the screen: of the section, and of the whole finger as a sum of slices.

A section that was pressed and is lifted has a force over the height of its bone, which is least, and negative, shortly
before the last ridge lets go. In the sum :math:`F(\delta) = \int w f(h / w) \,dz` each slice that was pressed
follows that curve from where it is. The pull-off force is the least of F. *Assumption*: slices that were pressed less
lift along the same curve, though their ridges adhere over less of their width.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fingerpad.slices.total import places, profile

if TYPE_CHECKING:
    from fingerpad.results.result import Result

PULL_OFF = "pull_off"
"""Key of a record: least force of the section, ``f_ext`` (N/m), and of the whole finger, ``finger`` (N)."""
_PULLS = 1e-6  # of the largest force: below it a lift has no pull-off


def with_pull_off(result: "Result") -> "Result":
    """Return a result whose bone lifts adhering skin with its pull-off force, as a record and in words."""
    force = np.array([state.f_ext for state in result.steps])
    least = int(force.argmin())
    if not force[least] < -_PULLS * force.max():
        return result
    depth = np.array([-state.bone_height for state in result.steps])
    first = int(depth[: least + 1].argmax())
    lifted = depth[first:][::-1], force[first:][::-1]  # at growing depths
    finger, slices = profile(result.scene.slices), result.scene.slices
    z, thickness = places(finger, float(depth[first]) * finger.centre_scale, slices.count)
    scale, rise = finger.width(z), finger.rise(z)
    sums = [thickness @ (scale * np.interp((at - rise) / scale, *lifted, left=0.0)) for at in lifted[0]]
    found = {"f_ext": float(force[least]), "finger": float(min(sums))}
    words = f"Pull-off: {-found['f_ext']:.3g} N/m, and about {-1e3 * found['finger']:.2g} mN of the whole finger."
    return replace(result, notes=(*result.notes, words), record=result.record | {PULL_OFF: found})
