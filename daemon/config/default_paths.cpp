// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>

#include <unistd.h>

#include "daemon/config/config.h"

namespace disparityd::daemon {
namespace {

/// Returns the first entry of a list of folders of the service manager; empty if the variable is not set.
std::string first_folder(const char* variable) {
    const char* value = std::getenv(variable);
    const std::string folders = value == nullptr ? "" : value;
    return folders.substr(0, folders.find(':'));
}

}  // namespace

std::string resolved_unix_path(const Config& config) {
    if (config.socket.unix_path != "auto") {
        return config.socket.unix_path;
    }
    const std::string& name = config.shared_memory.name;
    const std::string file = "disparityd" + (name == "default" ? "" : '-' + name);
    for (const std::string& folder :
         {first_folder("RUNTIME_DIRECTORY"), std::string("/run/disparityd"), first_folder("XDG_RUNTIME_DIR")}) {
        if (!folder.empty() && access(folder.c_str(), W_OK | X_OK) == 0) {
            return folder + '/' + file + ".sock";
        }
    }
    return "/tmp/" + file + '-' + std::to_string(getuid()) + ".sock";
}

RecordDirectory resolved_record_directory(const Config& config) {
    if (!config.record.directory.empty()) {
        return {config.record.directory, true};
    }
    std::string state = first_folder("STATE_DIRECTORY");
    if (!state.empty()) {
        return {state, true};
    }
    std::error_code gone;  // a reload must not fail here; a recording fails later and says why
    const std::filesystem::path here = std::filesystem::current_path(gone);
    return {gone ? "." : here.string(), false};
}

std::string resolved_correction_directory(const Config& config) {
    const std::string& directory = config.self_calibration.directory;
    return directory.empty() ? first_folder("STATE_DIRECTORY") : directory;
}

}  // namespace disparityd::daemon
