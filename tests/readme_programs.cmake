# Programs that pinode/README.md shows: a target for each C++ block with a main,
# and a test that runs it in the project's root, where its paths lead from.

# pinode_add_readme_program(NAME TITLE INDEX): the block number INDEX, from 0,
# below the heading `## TITLE`.
function(pinode_add_readme_program name title index)
  set(readme ${PROJECT_SOURCE_DIR}/pinode/README.md)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${readme})
  file(READ ${readme} text)
  string(FIND "${text}" "\n## ${title}\n" first)
  if(first EQUAL -1)
    message(FATAL_ERROR "${readme} has no heading '${title}'")
  endif()
  string(SUBSTRING "${text}" ${first} -1 text)
  set(begin "\n```cpp\n")
  string(LENGTH "${begin}" skipped)
  foreach(block RANGE ${index})
    string(FIND "${text}" "${begin}" first)
    if(first EQUAL -1)
      message(FATAL_ERROR "'${title}' in ${readme} lacks program ${index}")
    endif()
    math(EXPR first "${first} + ${skipped}")
    string(SUBSTRING "${text}" ${first} -1 text)
  endforeach()
  string(FIND "${text}" "\n```" last)
  string(SUBSTRING "${text}" 0 ${last} program)
  # Written where it has changed: a build is not to follow each configuration.
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cc)
  file(GENERATE OUTPUT ${source} CONTENT "${program}\n")
  add_executable(${name} ${source})
  target_link_libraries(${name} PRIVATE pinode::case)
  pinode_private_flags(${name})
  add_test(NAME readme.${name} COMMAND ${name}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(readme.${name} PROPERTIES LABELS slow TIMEOUT 300)
endfunction()
