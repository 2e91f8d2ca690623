# cmake -DPROGRAM=path -DSECTION=8 -DVERSION=x -DOUTPUT=file.gz [-DSUBCOMMANDS=ON] -P man_page.cmake
# Turns what `PROGRAM --help` says into a manual page, so that the two cannot differ. The help is laid
# out for it: "name - summary", then lines in capitals with indented text below them.
get_filename_component(name ${PROGRAM} NAME)

function(help_of variable)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  string(REPLACE "\\" "\\e" text "${text}")
  string(REPLACE "-" "\\-" text "${text}")
  string(REGEX REPLACE "(^|\n)([.'])" "\\1\\\\&\\2" text "${text}")
  set(${variable} "${text}" PARENT_SCOPE)
endfunction()

help_of(help)
string(FIND "${help}" "\n" end_of_summary)
string(SUBSTRING "${help}" 0 ${end_of_summary} summary)
string(SUBSTRING "${help}" ${end_of_summary} -1 body)
if(NOT body MATCHES "\n[A-Z][A-Z ]+\n")
  set(body "\nSYNOPSIS${body}")
endif()
string(REGEX REPLACE "\n([A-Z][A-Z ]+)\n" "\n.fi\n.SH \\1\n.nf\n" body "${body}")

set(page ".TH ${name} ${SECTION} \"\" \"depthscope ${VERSION}\"\n.SH NAME\n${summary}\n.nf${body}.fi\n")
if(SUBCOMMANDS)
  string(REGEX MATCH "COMMANDS\n[^A-Z]*(\n  [a-z][^\n]*)+" listed "\n${help}")
  string(REGEX MATCHALL "\n  [a-z][a-z\\-]+" commands "${listed}")
  string(APPEND page ".SH COMMANDS IN DETAIL\n")
  foreach(command ${commands})
    string(STRIP "${command}" command)
    string(REPLACE "\\-" "-" command "${command}")
    help_of(help ${command})
    string(APPEND page ".SS ${command}\n.nf\n${help}.fi\n")
  endforeach()
endif()

string(REGEX REPLACE "\\.gz$" "" plain ${OUTPUT})
file(WRITE ${plain} "${page}")
execute_process(COMMAND gzip -9nf ${plain} COMMAND_ERROR_IS_FATAL ANY)
