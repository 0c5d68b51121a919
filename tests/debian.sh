#!/bin/sh
# Runs `make suite`, all of pytest, in a bare Debian of another release: tests/debian.sh trixie|sid [PYTEST ARGUMENTS].
# Needs root and debootstrap. The system stays in $DEBIAN_ROOT, build/debian/RELEASE unless given: 4 GB; a second run
# finds it in place. Nothing outside of it is changed, mounts end with the script.
set -eu
cd "$(dirname "$0")/.."
release=${1:-}
case $release in
  trixie|sid) shift ;;
  *) echo "RELEASE=$release: must be trixie (Debian 13, dolfinx 0.9) or sid (unstable, 0.11)" >&2; exit 2 ;;
esac
[ "$(id -u)" = 0 ] || { echo "make test-debian needs root, for debootstrap and chroot" >&2; exit 2; }
command -v debootstrap >/dev/null || { echo "debootstrap is missing: apt-get install debootstrap" >&2; exit 2; }
root=${DEBIAN_ROOT:-$PWD/build/debian/$release}

if [ ! -e "$root/complete" ]; then
  rm -rf "$root"
  mkdir -p "$root"
  debootstrap --variant=minbase --include=ca-certificates,make "$release" "$root"
  # Unstable's index is signed for a week only, which a mirror may lag behind.
  echo 'Acquire::Check-Valid-Until "false";' >"$root/etc/apt/apt.conf.d/99lag"
  touch "$root/complete"
fi
cp /etc/resolv.conf "$root/etc/resolv.conf"
cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/ca-certificates.crt"

# The files under version control as they are here; the virtual environment there is kept.
mkdir -p "$root/work"
find "$root/work" -mindepth 1 -maxdepth 1 ! -name .venv -exec rm -rf {} +
git ls-files -z | tar --create --null --files-from=- | tar --extract --directory="$root/work"

export DEBIAN_FRONTEND=noninteractive LANG=C.UTF-8 HOME=/root PYTEST_ADDOPTS="$*"
unset PYTHONPATH VIRTUAL_ENV WHEELRAIL_CACHE VENV 2>/dev/null || true
exec unshare --mount --pid --fork sh -eu -c '
  mount --make-rprivate /
  mount -t proc proc "$0/proc"
  mount --rbind /dev "$0/dev"
  mount --rbind /sys "$0/sys"
  exec chroot "$0" sh -c "cd /work && PATH=/usr/sbin:/usr/bin:/sbin:/bin exec make suite"
' "$root"
