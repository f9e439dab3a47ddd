#!/usr/bin/python3
"""Gives the types of messages.idl the names that ROS 2 uses on the wire: pkg::msg::Type becomes pkg::msg::dds_::Type_, final.

usage: wire_names.py IN OUT
"""
import re
import sys

text = open(sys.argv[1]).read()
text = re.sub(r"(\w+::msg)::(\w+)", r"\1::dds_::\2_", text)
text = re.sub(r"  struct (\w+) \{(.*?)\n  \};", r"  module dds_ { @final struct \1_ {\2\n  }; };", text, flags=re.S)
open(sys.argv[2], "w").write(text)
