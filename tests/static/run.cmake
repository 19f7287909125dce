# Checks with one compiler what must compile and what must not:
#   cmake -DCOMPILER=... -DINCLUDES=<folders> -P run.cmake
# right.cpp and users_names.cpp compile without a warning; wrong.cpp does not compile, and gives exactly the errors
# that it expects.
cmake_minimum_required(VERSION 3.25)
set(call ${CMAKE_COMMAND} -E env LC_ALL=C ${COMPILER} -std=c++20 -fsyntax-only)
foreach(folder IN LISTS INCLUDES)
  list(APPEND call -I${folder})
endforeach()
execute_process(COMMAND ${COMPILER} --version OUTPUT_VARIABLE version COMMAND_ERROR_IS_FATAL ANY)
if(version MATCHES "clang")
  list(APPEND call -ferror-limit=0)
endif()

foreach(file right users_names)
  execute_process(COMMAND ${call} -Wall -Wextra -Wpedantic -Wshadow -Werror ${CMAKE_CURRENT_LIST_DIR}/${file}.cpp
                  COMMAND_ERROR_IS_FATAL ANY)
endforeach()

execute_process(COMMAND ${call} -Wfatal-errors -DKINECAL_HEADER_ONLY -x c++ -include kinecal/trust.hpp /dev/null
                RESULT_VARIABLE result ERROR_VARIABLE output)
if(result EQUAL 0 OR NOT output MATCHES "kinecal: trust.hpp is not header-only. link kinecal::solve")
  message(FATAL_ERROR "trust.hpp with KINECAL_HEADER_ONLY: ${output}")
endif()

# CMake would read semicolons and brackets as lists.
function(read_as_text variable)
  string(REGEX REPLACE "[][;]" "," text "${${variable}}")
  set(${variable} "${text}" PARENT_SCOPE)
endfunction()

set(source ${CMAKE_CURRENT_LIST_DIR}/wrong.cpp)
execute_process(COMMAND ${call} ${source} ERROR_VARIABLE output)
file(READ ${source} wrong)
read_as_text(output)
read_as_text(wrong)

function(fail text)
  message(NOTICE "${output}")
  message(FATAL_ERROR "${COMPILER} ${text}")
endfunction()

# The sentences, in order.
string(REGEX MATCHALL "// expect: [^\n]*" expected "${wrong}")
string(REGEX MATCHALL "error: [^\n]*" errors "${output}")
foreach(sentence error IN ZIP_LISTS expected errors)
  string(REPLACE "// expect: " "kinecal: " sentence "${sentence}")
  string(FIND "${error}" "${sentence}" place)
  if(NOT sentence OR place EQUAL -1)
    fail("should say '${sentence}', but says '${error}'")
  endif()
endforeach()

# The suggestions, in order, each letter by letter: DidYouMean<'a', 'r', 'm'>.
string(REGEX MATCHALL "// meant: [^\n]*" meant "${wrong}")
string(REGEX MATCHALL "DidYouMean<[^>]*>" suggested "${output}")
foreach(name suggestion IN ZIP_LISTS meant suggested)
  string(REGEX REPLACE "// meant: (nothing)?" "" name "${name}")
  string(REGEX REPLACE "DidYouMean<|>|'|, " "" suggestion "${suggestion}")
  if(NOT name STREQUAL suggestion)
    fail("should suggest '${name}', but suggests '${suggestion}'")
  endif()
endforeach()

list(LENGTH expected count)
message(STATUS "${COMPILER}: ${count} wrong lines give the expected errors")
