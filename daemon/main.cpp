// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>

#include <google/protobuf/stubs/common.h>
#if GOOGLE_PROTOBUF_VERSION < 4022000
#include <google/protobuf/stubs/logging.h>
#endif

#include "capture/message_text.h"
#include "daemon/command_line.h"
#include "daemon/daemon.h"
#include "daemon/engine.h"
#include "daemon/log.h"

namespace {

int run(int argc, char** argv) {
    const auto line = disparityd::read_command_line(argc, argv);
    if (!line) {
        return 0;
    }
    const disparityd::Config config = disparityd::load_config(line->daemon.config_path, line->daemon.overrides);
    disparityd::set_up_log(config.log);
#if GOOGLE_PROTOBUF_VERSION < 4022000
    google::protobuf::SetLogHandler(nullptr);  // it would print a line of its own for each bad message of a client
#endif
    if (line->check) {
        // What cannot be told from the text alone is refused where it is used.
        const disparityd::Engine would_run(config, {}, {});
        std::printf("disparityd: the configuration is valid\n");
        return 0;
    }
    disparityd::Daemon daemon(line->daemon, config);
    return daemon.run() ? 0 : 1;
}

void print_error(const std::exception& error) {
    const std::string line(error.what());
    std::fprintf(stderr, "disparityd: error: %s\n", disparityd::capture::shown(line, line.size()).c_str());
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::invalid_argument& error) {
        print_error(error);
        return 2;
    } catch (const std::exception& error) {
        print_error(error);
        return 1;
    }
}
