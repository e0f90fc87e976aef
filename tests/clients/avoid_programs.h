// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/daemon/daemon_process.h"

namespace disparityd::test {

/// The example that avoids obstacles, in one of its languages.
struct AvoidProgram {
    bool python = false;

    const char* name() const { return python ? "avoid.py" : "obstacle-avoidance-cpp"; }

    std::unique_ptr<DaemonProcess> start(const TemporaryFolder& folder, std::vector<std::string> arguments) const {
        if (!python) {
            return std::make_unique<DaemonProcess>(folder, arguments, DaemonProcess::Environment{}, AVOID_CPP);
        }
        arguments.insert(arguments.begin(), {"-B", AVOID_PY});
        const DaemonProcess::Environment environment{{"PYTHONPATH", AVOID_PYTHON_PATH}};
        return std::make_unique<DaemonProcess>(folder, arguments, environment, AVOID_PYTHON);
    }

    /// Returns why the program cannot run here; empty when it can.
    std::string missing() const {
        const std::string interpreter = AVOID_PYTHON;
        const std::string import = interpreter + " -c 'import numpy, google.protobuf' 2> /dev/null";
        return python && (interpreter.empty() || std::system(import.c_str()) != 0)
                   ? "no Python for this machine's programs, or no numpy or protobuf in it"
                   : "";
    }
};

inline std::ostream& operator<<(std::ostream& out, const AvoidProgram& program) {
    return out << program.name();
}

/// Returns the name of a case: "Cpp" or "Python".
inline std::string language_of(const AvoidProgram& program) {
    return program.python ? "Python" : "Cpp";
}

/// Waits for a line of the program that starts so.
inline ::testing::AssertionResult says(DaemonProcess& program, const std::string& start) {
    std::string heard;
    const bool found = program.wait_for_line([&](const std::string& line) {
        heard += "\n  " + line;
        return line.starts_with(start);
    });
    return found ? ::testing::AssertionSuccess()
                 : ::testing::AssertionFailure() << "no line \"" << start << "\", but" << heard << '\n'
                                                 << program.log();
}

}  // namespace disparityd::test
