// Shared by the C++ peers: reading and writing doubles, the clock, the report.
#pragma once
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

// Of this program alone; getrusage would count what the parent had before exec.
inline double peak_megabytes() {
    double kilobytes = 0;
    char line[256];
    if (std::FILE* status = std::fopen("/proc/self/status", "r")) {
        while (std::fgets(line, sizeof line, status)) std::sscanf(line, "VmHWM: %lf", &kilobytes);
        std::fclose(status);
    }
    return kilobytes / 1024;
}

inline std::vector<double> read_doubles(const char* path) {
    std::FILE* file = std::fopen(path, "rb");
    if (!file) { std::perror(path); std::exit(3); }
    std::fseek(file, 0, SEEK_END);
    std::vector<double> out(std::ftell(file) / 8);
    std::rewind(file);
    if (std::fread(out.data(), 8, out.size(), file) != out.size()) std::exit(4);
    std::fclose(file);
    std::printf("BASE %.1f\n", peak_megabytes());
    return out;
}

inline void write_doubles(const char* path, const std::vector<double>& v) {
    std::FILE* file = std::fopen(path, "wb");
    if (!file || std::fwrite(v.data(), 8, v.size(), file) != v.size()) std::exit(5);
    std::fclose(file);
    std::printf("RSS %.1f\n", peak_megabytes());
}

template <class F>
void timed(int repetitions, int inner, F run) {
    for (int k = 0; k <= repetitions; k++) {
        auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < inner; i++) run();
        std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        if (k) std::printf("T %.9f\n", took.count() / inner);
    }
}
