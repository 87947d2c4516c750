# make demo   press the default finger with 0.5 N, charge and slide it; results in results/demo
# make test   all tests, then those marked mpi on two ranks
# make check  tests of every module that run no whole finger
# make lint   style, layout and types: ruff and mypy, half a minute
# make test-pip  the same digits with dolfinx from PyPI, in a Python from 3.12 on: make test-pip PYTHON=python3.13
# make test-contact  rough contact beside the programs ContactMechanics and Adhesion of PyPI, in a venv; two minutes
# make test-order  all tests with other rounding: cells numbered the other way round, other kernels of OpenBLAS
# make fuzz   10 000 scenes and command lines and as many files, each read or refused in one sentence; an hour
# make pages  puts the kept numbers in place in docs/ and draws the pictures; seconds, no run
# make stale  how old the numbers of each page are; needs git
# make docs   the documentation site, in build/docs/index.html; a minute
# make notebook  a demo as a notebook of Jupyter, in results: make notebook DEMO=own_material
# make verify every number with a known answer, some minutes; docs/verification.md
# make paper  the statements of the paper beside this model's numbers; docs/paper.md, a quarter of an hour or more
# make paper FIGURE=6  a figure of the paper; python3 -m benchmarks.paper.figures lists them with their times
# make measured  findings on human fingers beside this model's numbers; docs/measured.md, a quarter of an hour
# make measured ROW=softer  one finding, or all of a finger; prints them
# make drive  friction over frequency and waveform of the voltage; docs/drive.md, a minute
# make fingers    friction of fingers by name side by side; docs/fingers.md
# make viscosity  how skin relaxes, energy of random histories, friction after a step of voltage; docs/laws.md
# make loads  seeded scenes of people's loads beside the closed form; docs/closed_form.md, an hour or two in pieces of twenty minutes
# make performance  counts, ratios and seconds, part by part, on an idle machine; docs/performance.md, half an hour
# make calibrate  keys found again from synthetic tables, cover of their regions; docs/calibrate.md, a quarter of an hour
# make calibration  estimated errors beside known ones, scene by scene; docs/errors.md, ten minutes
# make chart  error over work, one numerical setting after the other; docs/errors.md, half an hour or more
#
# With SUITE=sid in Debian unstable, that is with a newer dolfinx: make test SUITE=sid
# All but test-pip and test-contact need nothing but Debian 12, root, apt and PyPI: environment/run finds or makes what they run in.

run := environment/run

.PHONY: help demo lint test check test-pip test-contact test-order fuzz docs notebook pages stale verify paper measured drive fingers viscosity loads calibration chart performance

help:
	@sed -n 's/^# make/make/p' Makefile

demo:
	$(run) python3 -m fingerpad run --force "0.5 N" --out results/demo

lint:
	environment/lint

test:
	environment/wheels
	environment/docs --get || true
	FINGERPAD_CHROMIUM=$$(environment/browser) $(run) python3 -m pytest -q --color=no -n auto --dist worksteal -m "not long" tests
	$(run) mpirun -n 2 python3 -m pytest -q --color=no -p no:cacheprovider -m "not long" tests

check:
	environment/wheels
	FINGERPAD_CHROMIUM=$$(environment/browser) $(run) python3 -m pytest -q --color=no -n auto --dist worksteal -m "not long and not slow" tests

test-pip:
	SUITE=pip PYTHON="$(PYTHON)" $(run) python3 -m pytest -q --color=no tests/test_digits.py

# Debian's NumPy is too old for them, and these tests need no dolfinx.
test-contact:
	$(or $(PYTHON),python3) -m venv build/contact
	build/contact/bin/python -m pip install --quiet contactmechanics==1.8.3 adhesion==0.93 pytest
	build/contact/bin/python -c "import Adhesion.System"  # else its tests are skipped
	PYTHONPATH=. build/contact/bin/python -m pytest -q --color=no --noconftest -c /dev/null --rootdir . -W ignore \
		-k same_as tests/test_halfspace.py tests/test_adhesive_contact.py

test-order:
	environment/wheels
	FINGERPAD_CHROMIUM=$$(environment/browser) OPENBLAS_CORETYPE=Nehalem $(run) python3 -m pytest -q --color=no -n auto --renumber tests

fuzz:
	environment/wheels
	$(run) python3 -m tests.fuzz --count 10000
	$(run) python3 -m tests.fuzz --count 10000 --files

docs:
	environment/docs build/docs

notebook:
	$(run) python3 -m benchmarks.notebook $(or $(DEMO),first_run)

stale:
	python3 -m benchmarks.pages --stale

verify:
	$(run) python3 -m benchmarks.verification
	$(run) python3 -m pytest -q --color=no -n auto -m long tests
	$(run) mpirun -n 2 python3 -m pytest -q --color=no -p no:cacheprovider -m long tests

paper:
	$(run) python3 -m $(if $(FIGURE),benchmarks.paper.figures $(FIGURE),benchmarks.paper)

measured:
	$(run) python3 -m benchmarks.measured $(ROW)

loads:
	$(run) python3 -m benchmarks.loads.fresh
	$(run) python3 -m benchmarks.loads

calibration:
	$(run) python3 -m benchmarks.two_meshes

chart:
	$(run) python3 -m benchmarks.errors
	$(run) python3 -m benchmarks.chart

calibrate drive fingers pages performance viscosity:
	$(run) python3 -m benchmarks.$@
