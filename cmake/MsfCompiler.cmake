# Compiler flags shared by every target: `msf_compiler` carries them.
add_library(msf_compiler INTERFACE)
target_compile_options(msf_compiler INTERFACE -Wall -Wextra -Wpedantic)
# -ffp-contract=off would cost speed; determinism only needs the same binary to repeat itself.
# Debian's Eigen and Ceres agree on 32-byte alignment for x86-64-v3 as long as every room uses the same MSF_ARCH.
if(MSF_ARCH)
  add_compile_options(-march=${MSF_ARCH})
endif()
if(MSF_SANITIZE)
  add_compile_options(-fsanitize=${MSF_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${MSF_SANITIZE})
endif()
# Debian's Ceres and OpenCV are built for 16-byte vectors: the same alignment here keeps Eigen's memory functions compatible.
add_compile_definitions(EIGEN_MAX_ALIGN_BYTES=16)
find_program(MSF_CCACHE ccache)
if(MSF_CCACHE)
  # What it needs to know about precompiled headers.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${MSF_CCACHE})
  add_compile_options(-fpch-preprocess)
endif()
