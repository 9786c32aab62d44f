# SPDX-License-Identifier: Apache-2.0
"""Stands in for std_msgs.msg."""


class Bool:
    __slots__ = ("data",)

    def __init__(self):
        self.data = False


class Empty:
    __slots__ = ()
