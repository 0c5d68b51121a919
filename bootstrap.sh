#!/bin/sh
# Sets up everything on a bare Debian (12 or later): the compiled finite-element stack by apt, the rest by pip in a
# virtual environment on the system's Python, the only one that can import apt's dolfinx. Safe to run again.
# bootstrap.sh ready: what runs and draws; bootstrap.sh ready-for-notebooks: and JupyterLab; bootstrap.sh ready-to-test: and
# what tests and documentation need.
set -eu
cd "$(dirname "$0")"
venv=${VENV:-.venv}
state=${1:-ready}
case $state in
  ready) extras=view; builds=OFF targets="" with="" more="" ;;
  ready-for-notebooks) extras=view,notebook; builds=OFF targets="" with="" more="" ;;
  ready-to-test) extras=view,cluster,notebook,docs,dev; builds=ON targets="all library" with=ccache more=chromium ;;
  *) echo "bootstrap.sh $state: must be ready, ready-for-notebooks or ready-to-test" >&2; exit 2 ;;
esac

updated=""
apt() {
  missing=""
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  echo "installing by apt:$missing"
  sudo=""; [ "$(id -u)" = 0 ] || sudo=sudo
  [ -n "$updated" ] || $sudo apt-get update -q
  updated=yes
  # shellcheck disable=SC2086
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing
}
install() { "$venv/bin/python" -m pip install -q --no-compile --disable-pip-version-check "$@"; }

# The core needs a compiler and pip's tools alone: it is compiled while apt and pip, which use one processor, install the
# rest. The tools stay, to build it again after an edit: `make core`.
# shellcheck disable=SC2086
apt g++ python3-dev python3-venv $with
[ -x "$venv/bin/python" ] || /usr/bin/python3 -m venv --system-site-packages "$venv"
/usr/bin/python3 - "$extras" "$venv" <<'PY'
import sys
import tomllib
from pathlib import Path

extras, venv = sys.argv[1:]
about = tomllib.loads(Path("pyproject.toml").read_text())
project = about["project"]
needed = project["dependencies"] + sum((project["optional-dependencies"][extra] for extra in extras.split(",")), [])
for name, lines in {"build": about["build-system"]["requires"], "needed": needed}.items():
    Path(venv, f"{name}.txt").write_text("\n".join(lines) + "\n")
PY
install -r "$venv/build.txt"
echo "compiling the core and installing what it is used with"
PATH="$(cd "$venv" && pwd)/bin:$PATH"
{ cmake -S bindings -B bindings -G Ninja -DPython_EXECUTABLE="$(command -v python)" -DALL_BUILDS=$builds \
    && exec ninja -C bindings $targets; } >"$venv/core.log" 2>&1 &
core=$!
trap 'kill $core 2>/dev/null || true' EXIT
trap 'exit 130' INT TERM

# OpenBLAS: with the reference BLAS sparse factorisations take 4 to 8 times longer.
# shellcheck disable=SC2086
apt python3-dolfinx python3-dolfinx-real libopenblas0-pthread openmpi-bin python3-scipy python3-h5py python3-netcdf4 \
    libgl1 libegl1 libglu1-mesa libxcursor1 libxft2 libxinerama1 $more

# pip may not replace what the compiled stack was built against (NumPy 2 would break petsc4py, a bundled HDF5 dolfinx).
/usr/bin/python3 - >"$venv/constraints.txt" <<'PY'
from importlib.metadata import PackageNotFoundError, version

for name in ("numpy", "scipy", "mpi4py", "petsc4py", "slepc4py", "cffi", "h5py", "netCDF4",
             "fenics-dolfinx", "fenics-ufl", "fenics-ffcx", "fenics-basix"):
    try:
        print(f"{name}=={version(name)}")
    except PackageNotFoundError:
        pass
PY
install -c "$venv/constraints.txt" -r "$venv/needed.txt"
wait $core || { cat "$venv/core.log" >&2; exit 1; }
install --no-deps --no-build-isolation --config-settings=cmake.define.ALL_BUILDS=$builds -e .
"$venv/bin/python" -c "import dolfinx, numpy; print('dolfinx', dolfinx.__version__, '- numpy', numpy.__version__)"
touch "$venv/ready" "$venv/$state"  # whatever is ready for more is ready
[ "$state" != ready-to-test ] || touch "$venv/ready-for-notebooks"
