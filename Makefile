# make figures   set up, derive, prove, generate, report, draw a first look: out/index.html
# make paper     set up, then every figure in full, movie and claims; says first how long; goes on
# make test      set up and run the tests
# make slow      set up and run the longer studies; a pass is recorded in tests/SLOW.md
# make docs      set up and build the site: out/docs/index.html
# make clean     remove what make has built

PYTHON ?= python3
BIN := .venv/bin
TOGETHER := -n logical --maxprocesses 8 --dist loadfile

.PHONY: figures paper test slow docs clean

figures: .venv/ready
	$(BIN)/python -m derivations report
	$(BIN)/python -m derivations generate
	$(BIN)/python -m figures draw
	$(BIN)/python -m figures index

paper: .venv/ready
	$(BIN)/python -m figures paper

test: .venv/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python -m pytest $(TOGETHER)

slow: .venv/ready
	$(BIN)/python -m pytest $(TOGETHER) -m slow --record tests/SLOW.md

docs: .venv/docs
	$(BIN)/python -m sphinx -W --keep-going -q -d out/doctrees figures/pages/docs out/docs

# The environment is built once and again whenever the dependencies change.
.venv/ready: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "Python 3.11 or newer is needed: make PYTHON=python3.12 ..."; exit 1; }
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --editable '.[test]'
	touch $@

.venv/docs: .venv/ready
	$(BIN)/python -m pip install --quiet --editable '.[docs]'
	touch $@

clean:
	rm -rf .venv out build *.egg-info .pytest_cache .ruff_cache .mypy_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
