// SPDX-License-Identifier: Apache-2.0
//
// The guest's first process: makes the file systems, loads the kernel modules of /vm/modules, runs the program that the
// kernel's command line names after "--", says how it ended and switches the machine off. Where that name is "systemd",
// systemd becomes the first process instead, makes the file systems itself and starts this program again for the rest.
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

#include <fcntl.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

void mount_all() {
    struct FileSystem {
        const char* type;
        const char* place;
    };
    for (const auto& each :
         {FileSystem{"proc", "/proc"}, FileSystem{"sysfs", "/sys"}, FileSystem{"devtmpfs", "/dev"},
          FileSystem{"tmpfs", "/dev/shm"}, FileSystem{"tmpfs", "/run"}, FileSystem{"tmpfs", "/tmp"}}) {
        ::mkdir(each.place, 0755);
        if (::mount(each.type, each.place, each.type, 0, nullptr) != 0) {
            std::printf("vm: %s cannot be mounted: %s\n", each.place, std::strerror(errno));
        }
    }
}

// A line is a file and then the module's parameters.
void load_modules() {
    std::ifstream list("/vm/modules");
    std::string line;
    while (std::getline(list, line)) {
        std::istringstream words(line);
        std::string file;
        words >> file;
        std::string parameters;
        std::getline(words >> std::ws, parameters);
        const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
        if (::syscall(SYS_finit_module, descriptor, parameters.c_str(), 0) != 0) {
            std::printf("vm: %s cannot be loaded: %s\n", file.c_str(), std::strerror(errno));
        }
        ::close(descriptor);
    }
}

void start_loopback() {
    const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    ifreq request{};
    std::strcpy(request.ifr_name, "lo");
    request.ifr_flags = IFF_UP | IFF_RUNNING;
    if (::ioctl(socket, SIOCSIFFLAGS, &request) != 0) {
        std::printf("vm: no loopback: %s\n", std::strerror(errno));
    }
    ::close(socket);
}

// Children that lost their parents are init's to bury.
int run(char** command) {
    const pid_t child = ::fork();
    if (child == 0) {
        ::setenv("HOME", "/tmp", 1);
        ::setenv("PATH", "/vm", 1);
        ::setenv("LD_LIBRARY_PATH", "/vm/lib", 1);
        ::execv(command[0], command);
        std::printf("vm: %s cannot be run: %s\n", command[0], std::strerror(errno));
        std::fflush(stdout);
        ::_exit(127);
    }
    int status = 0;
    while (::wait(&status) != child) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

int main(int argc, char** argv) {
    if (::getpid() == 1) {
        const bool systemd = argc > 1 && std::string(argv[1]) == "systemd";
        if (!systemd) {
            mount_all();
        }
        load_modules();
        if (systemd) {
            ::execl("/usr/lib/systemd/systemd", "systemd", nullptr);
            std::printf("vm: systemd cannot be run: %s\n", std::strerror(errno));
        }
        start_loopback();
    }
    std::printf("vm: up\n");
    std::fflush(stdout);
    if (argc > 1) {
        const int status = run(argv + 1);
        std::printf("vm: exit status %d\n", status);
        std::fflush(stdout);
    }
    ::sync();
    ::reboot(RB_POWER_OFF);
    return 1;
}
