"""What people and nerves were measured to do, beside spikes: docs/measured.md, by ``python3 -m benchmarks.feel``."""
