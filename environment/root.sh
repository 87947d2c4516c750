#!/usr/bin/env bash
# Make the private Debian root that environment/run enters, and print its path: Debian 13, or with SUITE=sid the
# unstable one, whose newer dolfinx the code has to suit as well.
#
# The root lives in the user's cache folder under a name that holds a hash of the package list, is built
# beside its final place and renamed when whole: an interrupted build leaves nothing that looks finished,
# and a lock keeps two builds apart. Nothing outside the cache folder changes, except that missing build
# tools are installed with apt when root runs this.
set -euo pipefail

suite=${SUITE:-trixie}
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
need_gb=6  # the root and, for a moment, mmdebstrap's own copy of it

stop() { echo "fingerpad: $*" >&2; exit 1; }
say() { echo "fingerpad: $*" >&2; }

# environment/venv's reason why dolfinx does not come from PyPI here
others="or take another way (docs/command.md, Set-up): dolfinx from PyPI${FINGERPAD_LACKING:+ (here $FINGERPAD_LACKING)}, conda or a container."

home=${HOME:-$(getent passwd "$(id -u)" | cut -d: -f6 || true)}
cache=${XDG_CACHE_HOME:-${home:+$home/.cache}}/fingerpad
case $cache in
    /fingerpad) stop "you have no home folder; set HOME, or XDG_CACHE_HOME to a folder for 3 GB of Debian." ;;
    /*) ;;
    *) stop "XDG_CACHE_HOME is $XDG_CACHE_HOME; it must be a whole path, from / on." ;;
esac

# What runs in the root is the root's maker's choice: only the caller and the administrator may be that.
check_owner() {  # FOLDER
    local owner rights
    read -r owner rights < <(stat -L -c '%u %A' "$1")
    if [ "$owner" != "$(id -u)" ] && [ "$owner" != 0 ]; then
        stop "$1 belongs to $(stat -L -c %U "$1"), whose programs would be run; delete it, or set XDG_CACHE_HOME to a folder of your own."
    fi
    case $rights in
        d???????w[!tT]) stop "$1 can be written to by everybody, whose programs would be run; chmod o-w it, or set XDG_CACHE_HOME to another folder." ;;
    esac
}
found() {
    [ -d "$root" ] || return 1
    check_owner "$cache"
    check_owner "$root"
    echo "$root"
}

case $suite in
    trixie) name="Debian 13" ;;
    sid) name="Debian unstable" ;;
    *) stop "SUITE is $suite; it must be pip, trixie or sid." ;;
esac

packages=$(awk '!/^#/ && NF && $2 != "-" { print $2 }' "$here/packages.txt" | sort | paste -sd,)
# Documentation and translations are left out: a sixth of the size, and nobody reads them in there.
options=(--variant=apt --components=main
    --dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-exclude=/usr/share/man/*'
    --dpkgopt='path-exclude=/usr/share/locale/*' --aptopt='Apt::Install-Recommends "false"')
# A snapshot of unstable says of itself that it expired after a week.
[ "$suite" = sid ] && options+=(--aptopt='Acquire::Check-Valid-Until "false"')
key=$(printf '%s\n' "$suite" "$packages" "${options[@]}" | sha256sum | cut -c1-12)
root=$cache/$suite-$key

if found; then exit 0; fi

mkdir -p "$cache" 2>/dev/null || stop "cannot write to $cache; set XDG_CACHE_HOME to a folder you may write to."
check_owner "$cache"
exec 9>"$cache/build.lock"
flock -n 9 || { say "another build is running, waiting for it"; flock 9; }
if found; then exit 0; fi

# Under the lock whatever else is here is a leftover of a build that was killed.
rm -rf --one-file-system "$cache"/build.????????

free_gb=$(($(df --output=avail -k "$cache" | tail -n 1) / 1024 / 1024))
[ "$free_gb" -ge "$need_gb" ] ||
    stop "$cache has $free_gb GB free and the environment needs $need_gb GB; free some, or set XDG_CACHE_HOME to a larger disk."

tools=(mmdebstrap bubblewrap uidmap debian-archive-keyring tar util-linux ca-certificates)
missing=()
for tool in "${tools[@]}"; do
    dpkg-query -W -f='${Status}' "$tool" 2>/dev/null | grep -q 'ok installed' || missing+=("$tool")
done
if [ ${#missing[@]} -gt 0 ]; then
    [ "$(id -u)" = 0 ] ||
        stop "${missing[*]} missing: ask an administrator for 'apt-get install ${missing[*]}', $others"
    say "installing ${missing[*]} with apt"
    { apt-get update && apt-get install -y --no-install-recommends "${missing[@]}"; } >"$cache/apt.log" 2>&1 ||
        stop "apt could not install ${missing[*]} ($(grep -m 1 -E '^E:' "$cache/apt.log" || echo 'no message')); is there a network? All of it: $cache/apt.log"
fi

mode=root
if [ "$(id -u)" != 0 ]; then
    mode=unshare
    grep -q "^$(id -un):" /etc/subuid 2>/dev/null ||
        stop "user $(id -un) has no line in /etc/subuid: ask an administrator for 'usermod --add-subuids 100000-165535 --add-subgids 100000-165535 $(id -un)', $others"
fi
# Before minutes of building what could not be entered.
said=$(bwrap --unshare-user --ro-bind / / true 2>&1) ||
    stop "the kernel refuses user namespaces, which bubblewrap needs (${said##*$'\n'});" \
        "allow them (sysctl kernel.unprivileged_userns_clone=1, on Ubuntu 24.04 also" \
        "kernel.apparmor_restrict_unprivileged_userns=0), $others"

build=$(mktemp -d "$cache/build.XXXXXXXX")
trap 'rm -rf --one-file-system "$build" 2>/dev/null || true' EXIT
chmod 755 "$build"
mkdir -m 1777 "$build/tmp"

# Say which phase it is and how far it got: one line that changes on a terminal, else a line a quarter, and one after
# each 20 s in which nothing happened, or half a minute of slow work.
progress() {
    local line phase= of=0 count=0 text="starting" shown= last=$SECONDS code
    while true; do
        code=0
        IFS= read -r -t 20 line || code=$?
        if [ "$code" -gt 128 ]; then  # a line that is not whole yet would be lost: mmdebstrap writes whole ones
            last=$SECONDS
            if [ -t 2 ]; then printf '\r\033[K' >&2; fi
            say "$((SECONDS - start)) s, still $text"
            continue
        fi
        [ "$code" = 0 ] || break
        printf '%s\n' "$line" >>"$cache/build.log"
        case $line in
            *" newly installed, "*) [[ $line =~ ([0-9]+)\ newly ]] && of=${BASH_REMATCH[1]}; continue ;;
            "I: running apt-get update"*) text="fetching lists of packages" ;;
            Get:*) [ "$of" = 0 ] && continue; text="downloading packages" ;;
            "Setting up "*) text="installing packages" ;;
            "I: creating tarball"*) text="moving into place" ;;
            "unpacked "*) text="moving into place" ;;
            *) continue ;;
        esac
        if [ "$text" != "$phase" ]; then phase=$text count=0 shown=; fi
        count=$((count + 1))
        case $line in
            Get:* | Setting*) text="$text: $count of $of" ;;
            unpacked*) text="$text: ${line#unpacked }" ;;
        esac
        if [ -t 2 ]; then
            printf '\r\033[Kfingerpad: %s s, %s' $((SECONDS - start)) "$text" >&2
        elif [ -z "$shown" ] || { [ "$of" -gt 3 ] && [ $((count % (of / 4))) = 0 ]; } ||
            [[ $line == unpacked* ]] || [ $((SECONDS - last)) -ge 30 ]; then
            last=$SECONDS
            say "$((SECONDS - start)) s, $text"
        fi
        shown=yes
    done
    if [ -t 2 ]; then printf '\r\033[K' >&2; fi
}

say "making a private $name with dolfinx in $cache (once; about 3 minutes and 3 GB)"
start=$SECONDS
: >"$cache/build.log"
exec 8> >(progress 9>&-)
told=$!
built=yes
# mmdebstrap's user namespace owns files by other ids; through tar they become the caller's.
TMPDIR=$build/tmp mmdebstrap --verbose --mode=$mode --format=tar "${options[@]}" --include="$packages" "$suite" - 2>&8 |
    { mkdir "$build/root" && tar -x -C "$build/root" --no-same-owner --exclude='./dev/*' --checkpoint=25000 \
        --checkpoint-action='exec=echo "unpacked $((TAR_CHECKPOINT / 100)) MB" >&2' 2>&8; } || built=
exec 8>&-
wait "$told" || true
[ -n "$built" ] ||
    stop "the build failed: $(grep -E '^E:' "$cache/build.log" | tail -n 1 || true); is there a network? All of it: $cache/build.log"
touch "$build/root/etc/resolv.conf"
mv "$build/root" "$root"
say "made in $((SECONDS - start)) s"
echo "$root"
