#!/usr/bin/env bash
# Installs what is missing for `make demo` and `make bench` (a Vulkan loader and driver, and a C++ compiler, which
# meshoptimizer and FLIP take) or `make test` (also the validation layer, glTF models of other makers, and SwiftShader as a
# second driver; but for the models also for `make function`).
#   usage: tests/drivers.sh demo|bench|function|test
# As root it uses apt; otherwise it prints the one line to run and stops. Nothing is updated or
# downloaded where nothing is missing. SwiftShader goes to .drivers/ and is never installed.
set -euo pipefail
cd "$(dirname "$0")/.."
goal=${1:?usage: tests/drivers.sh demo|bench|function|test}
user_data=${XDG_DATA_HOME:-${HOME:-}/.local/share}

# have_driver NAME: whether a driver whose description's file name starts so is where the loader looks.
have_driver() {
    local folder
    for folder in "$user_data" /etc /usr/local/share /usr/share; do
        compgen -G "$folder/vulkan/icd.d/$1*.json" >/dev/null && return 0
    done
    return 1
}

have_layer() {
    local folder
    [ -e "${VK_LAYER_PATH:-}/VkLayer_khronos_validation.json" ] && return 0
    for folder in "$user_data" /etc /usr/local/share /usr/share; do
        [ -e "$folder/vulkan/explicit_layer.d/VkLayer_khronos_validation.json" ] && return 0
    done
    return 1
}

have_loader() {
    PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null | grep 'libvulkan\.so\.1' >/dev/null
}

missing=()
have_loader || missing+=(libvulkan1)
command -v cc >/dev/null || missing+=(gcc libc6-dev)
command -v make >/dev/null || missing+=(make)
case $goal in
demo | bench)
    # Any driver will do, also one that the environment names.
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}${VK_ADD_DRIVER_FILES:-}" ] || have_driver '' ||
        missing+=(mesa-vulkan-drivers)
    command -v c++ >/dev/null || missing+=(g++)
    ;;
function | test)
    have_driver lvp_icd || missing+=(mesa-vulkan-drivers)
    have_layer || missing+=(vulkan-validationlayers)
    command -v c++ >/dev/null || missing+=(g++)
    # Models of other makers, which the glTF reader is tried on.
    [ "$goal" = function ] || [ -n "${ANTUMBRA_GLTF_MODELS:-}" ] || [ -e /usr/share/assimp/models ] || missing+=(assimp-testmodels)
    ;;
*)
    echo "tests/drivers.sh: $goal is none of demo, bench, function and test" >&2
    exit 2
    ;;
esac

swiftshader=0
if [[ "$goal" = @(function|test) ]] && ! [ -e .drivers/libvk_swiftshader.so ]; then
    # Where one device is named, that one is tested and no other.
    case ${ANTUMBRA_DRIVER:-SwiftShader} in
    *[Ss]wift*) swiftshader=1 ;;
    esac
fi
if [ ${#missing[@]} -eq 0 ] && [ $swiftshader -eq 0 ]; then
    exit 0
fi

if ! command -v apt-get >/dev/null; then
    echo "This is not a Debian system, whose packages hold what is missing:" >&2
    echo "    ${missing[*]-} chromium-common (only for SwiftShader)" >&2
    echo "Install that by other means. make test needs no SwiftShader where ANTUMBRA_DRIVER names" >&2
    echo "another device." >&2
    exit 1
fi
install="apt-get install -y --no-install-recommends ${missing[*]}"
if [ "$(id -u)" -ne 0 ] && [ ${#missing[@]} -gt 0 ]; then
    echo "Some packages are missing. Run this, then make $goal again:" >&2
    echo "    sudo apt-get update && sudo $install" >&2
    exit 1
fi

export DEBIAN_FRONTEND=noninteractive
apt() {
    apt-get -qq -o DPkg::Lock::Timeout=300 "$@" </dev/null
}
if [ "$(id -u)" -eq 0 ]; then
    echo "updating the package lists"
    apt update
fi
if [ ${#missing[@]} -gt 0 ]; then
    echo "installing ${missing[*]}"
    apt install -y --no-install-recommends "${missing[@]}" >/dev/null
fi
if [ $swiftshader -eq 1 ]; then
    echo "unpacking SwiftShader from the package chromium-common into .drivers/"
    mkdir -p .drivers
    scratch=$(mktemp -d -p "$PWD/.drivers")
    trap 'rm -rf "$scratch"' EXIT
    if ! (cd "$scratch" && apt -o APT::Sandbox::User= download chromium-common); then
        echo "The package chromium-common, which holds SwiftShader, cannot be downloaded. Run" >&2
        echo "    sudo apt-get update" >&2
        echo "and make test again, or set ANTUMBRA_DRIVER=llvmpipe to test on lavapipe alone." >&2
        exit 1
    fi
    dpkg -x "$scratch"/chromium-common_*.deb "$scratch/unpacked"
    # The description names the library beside it, so the two stay together. The library, which is
    # what was looked for above, goes last: an interrupted run is not taken for a finished one.
    mv "$scratch/unpacked/usr/lib/chromium/vk_swiftshader_icd.json" .drivers/
    mv "$scratch/unpacked/usr/lib/chromium/libvk_swiftshader.so" .drivers/
fi
