"""Full states that Newton's method takes to targets of the default finger, from the closed form on.

environment/run python3 -m benchmarks.design     prints them, on facets of 30 µm; some 8 minutes
"""

import fingerpad as fp

TARGETS = (
    ("voltage", {"mu_app": 0.4}), ("electric.d_i", {"mu_app": 0.4}), ("friction", {"f_t": "30 N/m"}),
    ("f_ext", {"mu_app": 0.6}), ("roughness.h_rms", {"f_electrostatic": "60 N/m"}),
    ("electric.eps_i", {"contact_length": "1.65 mm"}),
    ("materials.stratum_corneum.shear_modulus", {"contact_length": "1.65 mm"}),
    (("friction", "electric.d_i"), {"f_t": ("20 N/m", "35 N/m"), "at": {"voltage": (0, 200)}}),
)  # fmt: skip

if __name__ == "__main__":
    scene = fp.Scene(output={"errors": False, "receptors": False}, mesh={"contact": 30e-6})
    for over, target in TARGETS:
        found = fp.solve(scene, over, model="full", **target)
        values = [[number.value for number in root.numbers] for root in found.roots]
        print(f"{over}, {target}: {found.values} after {len(found.states)} full states, with {values}", flush=True)
