"""Spikes of mechanoreceptive afferents: laws of classes of units, and thresholds over the frequency.

import fingerpad as fp

times = fp.afferents.SA1().spikes(stress, 1e-3)  # stress in Pa at equal times, 1 ms apart
fp.afferents.threshold("RA", 40.0)  # m
"""

from fingerpad.afferents.afferent import Afferent as Afferent
from fingerpad.afferents.afferent import History as History
from fingerpad.afferents.filtered import FilteredUnit as FilteredUnit
from fingerpad.afferents.linear import threshold as threshold
from fingerpad.afferents.pc import PC as PC
from fingerpad.afferents.ra1 import RA1 as RA1
from fingerpad.afferents.registry import LAWS as LAWS
from fingerpad.afferents.registry import find as find
from fingerpad.afferents.sa1 import SA1 as SA1
from fingerpad.afferents.unit_files import read_units as read_units
