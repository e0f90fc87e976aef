// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/token_file.h"

#include <fstream>
#include <stdexcept>

#include <sys/stat.h>

namespace disparity {

std::string read_token(const std::string& path) {
    if (path.empty()) {
        return {};
    }
    struct stat facts {};
    const bool found = ::stat(path.c_str(), &facts) == 0;
    if (found && !S_ISREG(facts.st_mode) && !S_ISDIR(facts.st_mode)) {  // a pipe would be waited for
        throw std::invalid_argument(path + ": the file with the token is not a regular file, allowed: a regular file");
    }
    std::ifstream file(path);
    if (!found || !file || S_ISDIR(facts.st_mode)) {
        throw std::invalid_argument(path + ": the file with the token cannot be read");
    }
    if ((facts.st_mode & (S_IROTH | S_IWOTH)) != 0) {
        throw std::invalid_argument(path + ": every user may read the token; chmod o-rw " + path);
    }
    constexpr const char* blanks = " \t\r";
    std::string line;
    while (std::getline(file, line)) {
        line.erase(line.find_last_not_of(blanks) + 1);
        if (!line.empty() && line.front() != '#') {
            return line.substr(line.find_last_of(blanks) + 1);
        }
    }
    throw std::invalid_argument(path + ": holds no token; write one into its first line");
}

}  // namespace disparity
