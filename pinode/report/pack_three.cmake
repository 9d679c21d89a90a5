# Writes three.js, packed, as a C++ source:
#
#   cmake -DSCRIPT=three.min.js -DOUTPUT=three_packed.cc -P pack_three.cmake

# Without SCRIPT there is nothing to pack.
set(packed)
if(SCRIPT)
  execute_process(
    COMMAND gzip -9 -n -c ${SCRIPT}
    COMMAND base64 -w 0
    OUTPUT_VARIABLE packed RESULTS_VARIABLE results)
  foreach(result IN LISTS results)
    if(NOT result EQUAL 0)
      message(FATAL_ERROR "${SCRIPT} could not be packed")
    endif()
  endforeach()
endif()
string(REGEX REPLACE "(................................................................................................................)"
  "\\1\"\n    \"" packed "${packed}")
file(WRITE ${OUTPUT} "#include \"pinode/report/three_packed.h\"

namespace pinode {

const char* ThreePacked() {
  static constexpr char kPacked[] =
    \"${packed}\";
  return kPacked;
}

}  // namespace pinode
")
