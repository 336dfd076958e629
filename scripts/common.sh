# What the scripts share; to be sourced. Every script prints what it does and ends with a sentence when it cannot go on.

say() { printf '== %s\n' "$*"; }

fail() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

# Compilers that run at once: one per processor, but no more than memory allows (1.5 GB each).
num_jobs() {
  local processors available_kb by_memory
  processors=$(nproc)
  available_kb=$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo)
  by_memory=$((available_kb / 1500000))
  ((by_memory < 1)) && by_memory=1
  echo $((processors < by_memory ? processors : by_memory))
}

# The CPU level to build for: the project's default needs AVX2; other machines get what their compiler takes for granted.
arch_option() {
  if grep -qw avx2 /proc/cpuinfo; then echo "-DMSF_ARCH=x86-64-v3"; else echo "-DMSF_ARCH="; fi
}

# configure FOLDER OPTION...: prepares a build folder once; later builds notice changes by themselves.
configure() {
  local folder=$1
  shift
  local wanted
  wanted="$(arch_option) $*"
  if [[ -f $folder/build.ninja && -f $folder/.configured && $(<"$folder/.configured") == "$wanted" ]]; then return; fi
  say "Configuring $folder"
  cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release "$(arch_option)" "$@" >"$folder.log" 2>&1 ||
    { cat "$folder.log" >&2; fail "The build could not be configured; the lines above say why."; }
  printf '%s\n' "$wanted" >"$folder/.configured"
}

# build FOLDER TARGET...
build() {
  local folder=$1
  shift
  say "Building $folder ($*) with $(num_jobs) jobs"
  cmake --build "$folder" -j "$(num_jobs)" --target "$@" || fail "The build failed; the lines above say where."
}
