# make run: the paper's curve, end to end (SCENE= another one).  make test: ruff, mypy and pytest.  Both set everything up first.
# make core: compiles what changed in C++.  make sanitize: tests it with sanitizers.
# make notebooks: the worked examples in JupyterLab (LAB= its options).
# Tests run in JOBS=2 processes.  make docs: the documentation, as pages.  make test-debian RELEASE=trixie|sid: the tests on another Debian, as root.
VENV ?= .venv
SCENE ?= scenes/curve.toml
RELEASE ?= trixie
JOBS ?= 2
PY = $(VENV)/bin/python
# What checks found is kept by the content that they looked at, for other clones, too; nothing needs it.
KEPT ?= $(or $(XDG_CACHE_HOME),$(HOME)/.cache)/wheelrail-checks
hash = $(shell sha256sum $(1) | sha256sum | cut -c1-16)
CORE = $(wildcard bindings/*.[ch]pp) $(shell find contact meshes vehicle wheelrail/support wheelrail/export -name '*.hpp')
# Ninja counts its jobs by itself.
TOOLS = MAKEFLAGS= PATH=$(abspath $(VENV))/bin:$$PATH
# One thread per process: the dense blocks are small, and threads that wait cost more than they bring.
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1

# Tests that draw in three dimensions have processes of their own: VTK aborted in ones that had run many other tests.
DRAWN = tests/scenes/test_view.py tests/scenes/test_report.py

# Makes a build of its own, `make sanitize`.
SANITIZED = tests/bindings/test_sanitized.py

# Files in their order: by default those of few tests are last, and some of them take a minute.
SHARED = -n $(JOBS) --dist loadfile --no-loadscope-reorder
PYTEST = MAKEFLAGS= $(PY) -m pytest

.PHONY: run core builds sanitized test lint sanitize suite notebooks docs test-debian test-kernels clean

run: core
	$(PY) -m wheelrail.cli run $(SCENE) --out results/$(basename $(notdir $(SCENE)))

# CMake's folder is beside its sources; the products are in wheelrail/bindings.
core: bindings/build.ninja
	$(if $(BUILT),,$(TOOLS) cmake --build bindings)

# Builds for other processors, too, and one with sanitizers: tests compare them.
builds: bindings/build.ninja
	$(TOOLS) cmake -DALL_BUILDS=ON bindings
	$(TOOLS) cmake --build bindings --target all library

sanitized: $(VENV)/ready-to-test
	$(TOOLS) cmake -S bindings -B build/sanitized -G Ninja -DSANITIZE=ON -DPython_EXECUTABLE=$(abspath $(PY))
	$(TOOLS) cmake --build build/sanitized

bindings/build.ninja: | $(VENV)/ready
	$(TOOLS) cmake -S bindings -B bindings -G Ninja -DPython_EXECUTABLE=$(abspath $(PY))

# Nothing waits for the checks of the sources: processors that the tests leave idle do them.
test: $(VENV)/ready-to-test
	$(MAKE) builds
	$(MAKE) -j3 BUILT=yes lint sanitize suite

# Types are checked against one set of libraries, Debian 12's: NumPy 2 describes its arrays otherwise.
lint: $(VENV)/ready-to-test
	@$(MAKE) core
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .
	$(PY) -m mypy --cache-dir $(KEPT)/mypy
	$(TOOLS) clang-format --dry-run -Werror $(CORE)
	@$(MAKE) $(TIDIED)

# As long as the core stays as it is, clang-tidy has nothing to say.
TIDIED = $(KEPT)/tidied-$(call hash,$(sort $(CORE)) .clang-tidy pyproject.toml Makefile)
$(TIDIED): | $(VENV)/ready-to-test
	@$(MAKE) core
	together=$$(ls bindings/CMakeFiles/contact-*/Unity/*.cxx | head -1); \
	others=$$(for file in bindings/*.cpp; do grep -q "/$$file" $$together || echo $$file; done); \
	printf '%s\n' $$together $$others | $(TOOLS) xargs -P $(JOBS) -I FILE clang-tidy --quiet FILE -- -std=c++20 -Iwheelrail -Ibindings \
	    $$($(PY) -c "import nanobind, sysconfig; print('-isystem', nanobind.include_dir(), '-isystem', sysconfig.get_path('include'))")
	-@mkdir -p $(@D) && touch $@

# Kernels with checked indices, addresses and arithmetic, in a build of their own.
sanitize: $(VENV)/ready-to-test
	@$(MAKE) core sanitized
	$(PYTEST) $(SANITIZED)

# Compliances of bodies, by the content of the sources that compute them.
SOLVED = $(KEPT)/solved-$(call hash,$(sort $(shell find contact forms meshes wheelrail/support -name '*.py' -o -name '*.hpp')) $(VENV)/constraints.txt)
suite: export WHEELRAIL_TEST_CACHE ?= $(shell mkdir -p $(SOLVED) && touch $(SOLVED) && echo $(SOLVED))
suite: $(VENV)/ready-to-test
	@$(MAKE) core
	-@find $(KEPT) -mindepth 1 -maxdepth 1 \( -name 'tidied-*' -o -name 'solved-*' \) -mtime +7 -exec rm -rf {} +
	$(PYTEST) $(SHARED) --max-worker-restart 0 $(DRAWN)
	$(PYTEST) $(SHARED) --max-worker-restart 0 $(patsubst %,--ignore=%,$(DRAWN) $(SANITIZED))

# Pairs of files: what is saved in JupyterLab goes to the text files, too.
notebooks: $(VENV)/ready-for-notebooks
	@$(MAKE) core
	$(PY) -m jupytext --quiet --update --to ipynb notebooks/*.py
	$(PY) -m jupyterlab --notebook-dir=notebooks $(if $(filter 0,$(shell id -u)),--allow-root) $(LAB)

# The same on an old processor: OpenBLAS's first kernels, and the core without later instructions.
test-kernels: $(VENV)/ready-to-test
	@$(MAKE) builds
	OPENBLAS_CORETYPE=Prescott WHEELRAIL_CORE=$(CURDIR)/wheelrail/bindings/baseline $(PY) -m pytest $(SHARED) tests/contact tests/vehicle

docs: $(VENV)/ready-to-test
	@$(MAKE) core
	DOCS_NOTEBOOKS=cache $(PY) -m sphinx -W --keep-going -q -b html -d build/doctrees docs build/docs
	@echo build/docs/index.html

test-debian:
	tests/debian.sh $(RELEASE)

$(VENV)/ready $(VENV)/ready-for-notebooks $(VENV)/ready-to-test: pyproject.toml bootstrap.sh
	VENV=$(VENV) ./bootstrap.sh $(@F)

clean:
	rm -rf $(VENV) build *.egg-info results
