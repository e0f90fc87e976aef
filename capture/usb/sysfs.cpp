// SPDX-License-Identifier: Apache-2.0
#include "capture/usb/sysfs.h"

#include <charconv>
#include <fstream>

#include "base/words.h"

namespace disparityd::capture::sysfs {

namespace fs = std::filesystem;

std::string attribute(const fs::path& folder, const char* name) {
    std::ifstream file(folder / name);
    std::string line;
    std::getline(file, line);
    return std::string(base::trim(line));
}

int number(const std::string& text, int base) {
    int value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value, base);
    return value;
}

std::vector<fs::path> entries(const fs::path& folder) {
    std::vector<fs::path> list;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        list.push_back(entry->path());
    }
    return list;
}

bool node_before(const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
}

fs::path usb_device(const fs::path& device) {
    // A video device hangs on an interface of the USB device, a hidraw device on a HID device of an interface.
    constexpr int most_parents = 3;
    std::error_code error;
    fs::path folder = fs::canonical(device, error);
    for (int i = 0; !error && i < most_parents; ++i, folder = folder.parent_path()) {
        if (fs::exists(folder / "idVendor", error)) {
            return folder;
        }
    }
    return {};
}

}  // namespace disparityd::capture::sysfs
