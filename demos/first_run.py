# %% [markdown]
# # First run
#
# A finger is pressed on a screen with 0.5 N, the voltage of the screen is switched on, and the finger slides. The attraction adds to the contact pressure, and friction follows the contact pressure: so the apparent
# friction µ_app, friction force over external force, is above the friction coefficient of 0.25. The headline has that of
# the whole finger; that of the middle section is in plane strain, per metre of finger.
#
# The lines are those of the README and of docs/laws.md. The tests run them on a small finger.

# %%
# fmt: off
import fingerpad as fp

scene = fp.Scene(force="0.5 N", voltage=200.0, friction=0.25)      # SI units; every other key has a default
curve = fp.sweep(scene, model="cylinders", finger=["paper", "fitted"], voltage=[0, 100])  # a closed form: seconds
print(curve)

result = fp.run(scene, out="results/mine")                         # finite elements: a minute or two
print(result.headline)                                             # of the whole finger
slip = result.full_slip                                            # its middle section; also .uncharged, .charged
print(f"middle section: µ_app = {slip.mu_app:.4f} ± {slip.error.mu_app:.4f}, {slip.f_ext:.0f} N/m")
result.plot("footprint", "footprint.png")                          # gross contact, ridges and pressure from below

# fmt: on
# %% [markdown]
# Next: one ridge by itself.

# %%
ridge = fp.Body(
    fp.geometry.ridge(size=10e-6),
    fp.Ogden(86.76e3, -14.53, 0.48),
    contact=fp.Penalty(1.5e12, 5e10),
    friction=0.25,
    roughness=fp.BearingArea(h_0=0.51e-6),
)
ridge.press(4.4).charge(200.0).slide(until_full_slip=True)
print(ridge.state.mu_app, ridge.state.d_eq, ridge.displacement.shape)  # arrays with documented shapes
print(ridge.cautions)  # limits of validity that its states reach; none here

# %% [markdown]
# Two laws hold at full slip, whatever the body. The screen bears the bone's load and the attraction. The friction force
# is the friction coefficient times the contact force, since every point in contact slips.

# %%
assert not ridge.cautions
for state in (slip, ridge.state):
    assert abs(state.f_contact - state.f_electrostatic - state.f_ext) < 1e-6 * state.f_ext
    assert abs(state.f_t - 0.25 * state.f_contact) < 1e-6 * state.f_ext

# %% [markdown]
# Without a voltage the closed form has the friction coefficient itself, and a higher voltage means more friction.

# %%
mu = curve.array("mu_app")
for still, charged in mu:  # of each finger
    assert abs(still - 0.25) < 1e-12
    assert still < charged
