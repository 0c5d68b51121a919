# make run: the paper's curve, end to end (SCENE= another one).  make test: ruff, mypy and pytest.  Both set everything up first.
VENV ?= .venv
SCENE ?= scenes/curve.toml
PY = $(VENV)/bin/python
# One thread per process: the dense blocks are small, and threads that wait cost more than they bring.
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: run test clean

run: $(VENV)/ready
	$(PY) -m scenes.cli run $(SCENE) --out results/$(basename $(notdir $(SCENE)))

test: $(VENV)/ready
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .
	$(PY) -m mypy
	$(PY) -m pytest

$(VENV)/ready: pyproject.toml bootstrap.sh
	VENV=$(VENV) ./bootstrap.sh

clean:
	rm -rf $(VENV) build *.egg-info results
