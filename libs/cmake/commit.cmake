# cmake -DSOURCE=... -DOUT=commit.cpp -P commit.cmake: which commit is checked out, as a source file. Runs in every build,
# and writes where that has changed only.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git describe --always --dirty --abbrev=12 WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "#include \"commit.h\"

namespace fathom {
const char* commit() { return \"@commit@\"; }
}  // namespace fathom
" @ONLY)
