// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace vm_guest {

/// What a program said and how it ended.
struct Said {
    int status = -1;
    std::string text;  ///< standard output and error
};

/// Runs a program of /usr/bin with the system's own libraries and waits for its end.
Said run_system_program(std::vector<std::string> arguments);

/// A unit of the guest's systemd.
class SystemUnit {
public:
    explicit SystemUnit(std::string name) : name_(std::move(name)) {}

    /// systemctl VERB UNIT
    Said order(const std::string& verb) const { return run_system_program({"systemctl", verb, name_}); }

    /// Such as "ActiveState", "StatusText", "MainPID".
    std::string property(const std::string& property) const;
    int main_process() const { return std::stoi(property("MainPID")); }

    /// Whether its status line comes to hold the text.
    bool comes_to_say(const std::string& text) const;

    /// What a failed test shows.
    std::string journal() const {
        return run_system_program({"journalctl", "--no-pager", "-n", "40", "-u", name_}).text;
    }

private:
    std::string name_;
};

}  // namespace vm_guest
