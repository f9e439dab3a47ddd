#pragma once

extern int fake_query;       ///< answer of the device when it is asked whether it works; 600: it is busy
extern int fake_allocation;  ///< answer to requests for memory
extern int fake_layout[4];   ///< layout that the code of the problem has
