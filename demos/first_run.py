# %% [markdown]
# # First run
#
# A finger is pressed on a screen with 75 N per metre of its length, the voltage of the screen is switched on, and the
# finger slides. The attraction adds to the contact pressure, and friction follows the contact pressure: so the apparent
# friction µ_app = f_T / f_ext is above the friction coefficient of 0.25.
#
# The lines below are those of the README. On the whole finger the sweep, of ten full runs, takes most of the time.
# The tests run them on a small finger.

# %%
# fmt: off
import fingerpad as fp

scene = fp.Scene(f_ext=75.0, voltage=200.0, friction=0.25)       # SI; everything else has a default
result = fp.run(scene)                                            # out="..." also writes tables, plots, fields
slip = result.full_slip                                           # likewise .uncharged, .charged, .steps
print(f"{slip.mu_app:.3f} ± {slip.error.mu_app:.3f}, {slip.ridges_in_contact} ridges")
result.plot("surface")                                            # or "finger", "history"

fast  = fp.run(scene, model="smooth")                             # seconds; "cylinders" at once
exact = fp.run(scene.replace(accuracy={"mu_app": 0.01}))
curve = fp.sweep(scene, voltage=[0, 50, 100, 150, 200], f_ext=[25, 75], jobs=2)   # a table; kept on disk, taken up again

ridge = fp.Body(fp.geometry.ridge(size=10e-6), fp.Ogden(86.76e3, -14.53, 0.48),
                contact=fp.Penalty(1.5e12, 5e10), friction=0.25, roughness=fp.BearingArea(h_0=0.51e-6))
ridge.press(4.4).charge(200.0).slide(until_full_slip=True)
print(ridge.state.mu_app, ridge.state.d_eq, ridge.displacement)   # arrays with documented shapes

# fmt: on
# %% [markdown]
# What a run found is printed as a block, with units and estimated errors. A sweep prints a table.

# %%
for answer in (result, fast, exact, curve):
    print(answer)

# %% [markdown]
# Three laws hold at full slip, whatever the finger. The screen bears the bone's load and the attraction. The friction
# force is the friction coefficient times the contact force, since every point in contact slips. A higher voltage means
# more friction.

# %%
for state in (slip, exact.full_slip, ridge.state):
    assert abs(state.f_contact - state.f_electrostatic - state.f_ext) < 1e-6 * state.f_ext
    assert abs(state.f_t - 0.25 * state.f_contact) < 1e-6 * state.f_ext
assert (abs(curve.array("mu_app")[0] - 0.25) < 1e-6).all()  # the first voltage is 0 V
assert (curve.array("mu_app")[-1] > curve.array("mu_app")[0]).all()

# %% [markdown]
# The accuracy asked for is met, by the run's own estimate. The smooth finger is a cheaper model of the same finger; a
# fifth is what it may be off by on very small fingers.

# %%
assert exact.full_slip.error.mu_app <= 0.01 * exact.full_slip.mu_app
assert abs(fast.full_slip.mu_app - exact.full_slip.mu_app) < 0.2 * exact.full_slip.mu_app
