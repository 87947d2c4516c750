"""What lies between finger and electrode, in numbers alone: no UFL, for the closed form and for scenes."""

VACUUM_PERMITTIVITY = 8.854e-12  # F/m, Table 3


def insulator_thickness(d_sc: float, eps_sc: float, d_i: float, eps_i: float) -> float:
    """Return h_0 (m), the effective insulator thickness of stratum corneum and screen coating."""
    return d_sc / eps_sc + d_i / eps_i
