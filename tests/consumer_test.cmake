# Installs the project to an empty folder, builds examples/live against it, runs it, and looks at what it links.
# Needs BUILD_FOLDER, SOURCE_FOLDER, WORK_FOLDER, COMPILER.
file(REMOVE_RECURSE ${WORK_FOLDER})
set(prefix ${WORK_FOLDER}/prefix)

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run("installing" ${CMAKE_COMMAND} --install ${BUILD_FOLDER} --prefix ${prefix})
run("configuring examples/live" ${CMAKE_COMMAND} -S ${SOURCE_FOLDER}/examples/live -B ${WORK_FOLDER}/build -G Ninja
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_PREFIX_PATH=${prefix})
run("building examples/live" ${CMAKE_COMMAND} --build ${WORK_FOLDER}/build)
# The data must come from the installation, not from the source tree.
run("running examples/live" ${CMAKE_COMMAND} -E env MSF_SLAM_DATA=${prefix}/share/msf_slam ${WORK_FOLDER}/build/live)
message(STATUS "${output}")

run("ldd" ldd ${WORK_FOLDER}/build/live)
foreach(unwanted highgui torch libQt libgtk libGL\\.)
  if(output MATCHES "${unwanted}")
    message(FATAL_ERROR "the library links ${unwanted}:\n${output}")
  endif()
endforeach()

# What is installed must not remember where it was built.
file(GLOB_RECURSE cmake_files ${prefix}/*.cmake)
foreach(file ${cmake_files})
  file(READ ${file} text)
  string(FIND "${text}" "${SOURCE_FOLDER}/" found)
  if(NOT found EQUAL -1)
    message(FATAL_ERROR "${file} names the source folder")
  endif()
endforeach()
