#pragma once

extern int fake_query;       ///< answer of the device when it is asked whether it works; 600: it is busy
extern int fake_allocation;  ///< answer to requests for memory
extern int fake_images;      ///< images that the device does not run
/// Runs a kernel in `blocks` blocks.
extern void (*fake_launch)(const char* kernel, int blocks, int shared_bytes, const void* argument);
