# Writes three.js, packed, as a C++ source:
#
#   cmake -DSCRIPT=three.min.js -DOUTPUT=three_packed.cc -P pack_three.cmake
#   cmake -DSCRIPT=three.module.js -DBUNDLER=esbuild -DUSER=script.js
#     -DOUTPUT=three_packed.cc -P pack_three.cmake
#
# With a bundler, of the module SCRIPT only what USER names as THREE.<name>, and
# what that needs.

if(SCRIPT AND BUNDLER)
  file(READ ${USER} user)
  string(REGEX MATCHALL "THREE\\.[A-Za-z0-9]+" names "${user}")
  list(TRANSFORM names REPLACE "THREE\\." "")
  list(REMOVE_DUPLICATES names)
  list(JOIN names ", " names)
  set(parts ${OUTPUT}.parts.js)
  file(WRITE ${parts} "export {${names}} from '${SCRIPT}';\n")
  execute_process(
    COMMAND ${BUNDLER} ${parts} --bundle --minify --format=cjs
      --legal-comments=none --log-level=warning --outfile=${OUTPUT}.bundle.js
    RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "the parts of ${SCRIPT} could not be bundled")
  endif()
  set(SCRIPT ${OUTPUT}.bundle.js)
endif()

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
