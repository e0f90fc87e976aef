// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// Reading what the kernel shows of its devices. Whatever is not there reads as nothing.
namespace disparityd::capture::sysfs {

/// Returns the first line of a file of this folder, without white space around it.
std::string attribute(const std::filesystem::path& folder, const char* name);

/// Reads the number that the text begins with; 0 where there is none.
int number(const std::string& text, int base);

/// Lists a folder, such as that of a class or bus.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

/// Orders a class's device nodes: "/dev/video10" comes after "/dev/video9".
bool node_before(const std::string& a, const std::string& b);

/// Returns the folder of the USB device that a device belongs to, which is one of its parents; empty for others.
/// `device` is the link "device" in a class's folder.
std::filesystem::path usb_device(const std::filesystem::path& device);

}  // namespace disparityd::capture::sysfs
