# %% [markdown]
# # A finger by one's own table
#
# Friction forces over voltage give the friction coefficient of a finger and the roughness of its ridges. They cannot
# tell the thickness of a coating from its permittivity. The table here is made by the closed form from known values,
# with 3 % of noise, for six participants who differ in friction; so it is known what must come out.

# %%
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import fingerpad as fp

FRICTION, SPREAD = 0.3, 0.25  # friction coefficient of people, and the spread between them
H_RMS = 3.6e-6  # m
FORCES, VOLTAGES, NOISE = (0.2, 0.5, 1.0), (0.0, 100.0, 200.0), 0.03  # N, V


# %% [markdown]
# A table has names and units in its header, a row for each measurement, and a participant where there are several.


# %%
def measured() -> pd.DataFrame:
    """Return the table."""
    rng, rows = np.random.default_rng(5), []
    for participant in range(1, 7):
        friction = FRICTION * np.exp(SPREAD * rng.normal())
        for force in FORCES:
            for voltage in VOLTAGES:
                scene = fp.Scene(force=force, voltage=voltage, friction=friction, roughness={"h_rms": H_RMS})
                f_t = fp.run(scene, model="cylinders").finger.full_slip.f_t
                rows.append((participant, force, voltage, round(f_t * np.exp(NOISE * rng.normal()), 4)))
    return pd.DataFrame(rows, columns=["participant", "force (N)", "voltage (V)", "friction force (N)"])


def main(out: str = "results/demos/calibrate_a_finger") -> None:
    """Write a table, calibrate the default finger by it, and predict a participant who is left out."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    table = measured()
    table.to_csv(folder / "people.csv", index=False)
    keys = ["friction", "roughness.h_rms"]
    found = fp.calibrate(table, fp.Scene(force=0.5), keys, hold_out={"participant": 2}, out=None)
    print(found)

    # %% [markdown]
    # Thickness and permittivity of the coating act by their ratio alone. A table cannot tell the two apart.

    # %%
    coating = fp.calibrate(table, fp.Scene(force=0.5), ["electric.d_i", "electric.eps_i"], out=None, evidence=False)
    print(*coating.ties, sep="\n")

    figure, ax = plt.subplots(figsize=(5.5, 3.8), layout="constrained")
    rows = found.rows[found.rows.held_out]
    for colour, (voltage, each) in zip(("#0072B2", "#E69F00", "#000000"), rows.groupby("voltage"), strict=True):
        ax.fill_between(each.force, each.low, each.high, color=colour, alpha=0.15)
        ax.plot(each.force, each.measured, "o", color=colour, label=f"measured, {voltage:g} V")
    ax.set(xlabel="force (N)", ylabel="friction force (N)", title="A participant who was held out, and the band")
    ax.legend()
    figure.savefig(folder / "held_out.png")

    # %% [markdown]
    # Assertions: the values that made the table are in their regions, Coulomb's law is chosen, and the participant is
    # within the band.

    # %%
    for key, value in {"friction": FRICTION, "roughness.h_rms": H_RMS}.items():
        assert found.values.low[key] < value < found.values.high[key]
    laws = found.evidence[found.evidence.kind == "friction law"].set_index("name")
    assert laws.AICc.idxmin() == "Coulomb"
    assert rows.measured.between(rows.low, rows.high).all()
    assert len(coating.ties) == 1 and "electric.d_i and electric.eps_i" in coating.ties[0]


if __name__ == "__main__":
    main(*sys.argv[1:])
