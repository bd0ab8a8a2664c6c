# Warnings and sanitizers, in one interface target that only our own targets use.
add_library(ferrers_warnings INTERFACE)
target_compile_options(ferrers_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
                                                  -Wno-maybe-uninitialized -Wno-restrict)  # g++ 12 misjudges both in library code
if(FERRERS_WERROR)
  target_compile_options(ferrers_warnings INTERFACE -Werror)
endif()
if(FERRERS_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
# Results must not depend on the machine that built them: no -march=native, no fast-math, no contraction.
# x86-64-v2 (2009 and later) is the baseline of what is shipped.
add_compile_options(-ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-march=x86-64-v2)
endif()
