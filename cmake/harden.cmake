# Checks of the stack and of calls that write to buffers; symbols bound at the start and read-only from then
# on; no executable stack. SECURITY.md names them, and the test `install_hardening` looks for them in the
# installed files. The ROS nodes, which are projects of their own, include this file, too.
function(slalom_harden target)
  # Ubuntu's compiler defines _FORTIFY_SOURCE by itself; it needs optimised code.
  target_compile_options(${target} PRIVATE -fstack-protector-strong
    "$<$<CONFIG:Release,RelWithDebInfo,MinSizeRel>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>")
  target_link_options(${target} PRIVATE LINKER:-z,relro LINKER:-z,now LINKER:-z,noexecstack)
endfunction()
