// SPDX-License-Identifier: Apache-2.0
#include "base/access/tokens.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <stdexcept>

#include <openssl/crypto.h>
#include <sys/stat.h>
#include <unistd.h>

namespace disparityd::base {
namespace {

constexpr std::size_t least_token = 16;
constexpr std::size_t most_token = 256;

bool same(std::string_view a, std::string_view b) {
    return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

bool any_of(const std::vector<std::string>& tokens, std::string_view token) {
    bool found = false;
    for (const std::string& other : tokens) {
        found = same(other, token) || found;
    }
    return found;
}

bool is_token(std::string_view text) {
    return text.size() >= least_token && text.size() <= most_token &&
           std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isgraph(c); });
}

}  // namespace

Right Tokens::right_of(std::string_view token) const {
    const bool controls = any_of(controllers_, token);
    const bool views = any_of(viewers_, token);
    return controls ? Right::control : views ? Right::view : Right::none;
}

void check_secret_file(const std::string& path, const std::string& what) {
    struct stat facts {};
    if (stat(path.c_str(), &facts) != 0 || S_ISDIR(facts.st_mode) || access(path.c_str(), R_OK) != 0) {
        throw std::invalid_argument(path + ": the file with " + what + " cannot be read");
    }
    if (!S_ISREG(facts.st_mode)) {  // the program would wait for the bytes of a pipe
        throw std::invalid_argument(path + ": the file with " + what +
                                    " is not a regular file, allowed: a regular file");
    }
    if ((facts.st_mode & (S_IROTH | S_IWOTH)) != 0) {
        throw std::invalid_argument(path + ": every user may read " + what + "; chmod o-rw " + path);
    }
}

Tokens read_tokens(const std::string& path) {
    check_secret_file(path, "the tokens");
    std::ifstream file(path);
    std::vector<std::string> viewers;
    std::vector<std::string> controllers;
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        if (line.empty() || line.front() == '#') {
            continue;
        }
        const std::size_t blank = line.find(' ');
        const std::string word = line.substr(0, blank);
        const std::string token = blank == std::string::npos ? "" : line.substr(blank + 1);
        if ((word != "view" && word != "control") || !is_token(token)) {
            throw std::invalid_argument(
                path + ":" + std::to_string(number) +
                ": allowed: \"view TOKEN\" or \"control TOKEN\", a token of 16 to 256 characters "
                "without blanks, such as openssl rand -hex 16 makes");
        }
        (word == "view" ? viewers : controllers).push_back(token);
    }
    if (viewers.empty() && controllers.empty()) {
        throw std::invalid_argument(path + ": holds no token; add a line \"view TOKEN\" or \"control TOKEN\"");
    }
    return {std::move(viewers), std::move(controllers)};
}

}  // namespace disparityd::base
