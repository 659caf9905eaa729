// A mapper of your own in C++, with the standard library alone: the share of looks at a cell that hit it.
// Build: c++ -O2 -std=c++17 -o counting counting.cpp
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

// The first number behind a key of a JSON file, or one behind it: enough for one sensor; a JSON library is better.
double number(std::ifstream file, const std::string& key, int skip = 0) {
    const std::string json{std::istreambuf_iterator<char>(file), {}};
    auto at = json.find(':', json.find('"' + key + '"'));
    for (; skip > 0; --skip) at = json.find(',', at);
    return std::stod(json.substr(json.find_first_of("-0123456789", at)));
}

int main(int count, char** words) {
    const std::string folder = words[count - 1], grid = folder + "/grid.json", sensors = folder + "/sensors.json";
    const double cell = number(std::ifstream(grid), "cell_m");
    const double x0 = number(std::ifstream(grid), "origin_m"), y0 = number(std::ifstream(grid), "origin_m", 1);
    const int width = number(std::ifstream(grid), "width"), height = number(std::ifstream(grid), "height");
    const double focal_baseline = number(std::ifstream(sensors), "focal_baseline"), prior = number(std::ifstream(sensors), "occupancy");
    std::vector<float> passed(width * height), hits(width * height), map(width * height);
    std::ifstream scans(folder + "/scans.csv");
    for (std::string line; std::getline(scans, line);) {
        double x, y, theta, bearing, disparity;  // behind scan, time_s and sensor
        const char* form = "%*d,%*f,%*d,%lf,%lf,%lf,%lf,%lf";
        if (std::sscanf(line.c_str(), form, &x, &y, &theta, &bearing, &disparity) < 5) continue;  // the heads, or no reading
        const double range = focal_baseline / (std::fmax(disparity, 0.1) * std::cos(bearing));
        for (int step = 0, steps = std::fmin(range, 30.0) / (0.5 * cell); step <= steps; ++step) {
            const double r = step == steps ? range : 0.5 * cell * step;
            const int i = std::floor((x + r * std::cos(theta + bearing) - x0) / cell), j = std::floor((y + r * std::sin(theta + bearing) - y0) / cell);
            if (0 <= i && i < width && 0 <= j && j < height) (step == steps ? hits : passed)[j * width + i] += 1;
        }
    }
    for (int k = 0; k < width * height; ++k) map[k] = hits[k] + passed[k] > 0 ? (hits[k] + prior) / (hits[k] + 0.5 * passed[k] + 1) : NAN;
    const std::string head = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(height) + ", " + std::to_string(width) + "), }\n";
    std::ofstream out(folder + "/occupancy.npy", std::ios::binary);
    out.write("\x93NUMPY\x01\x00", 8).put(head.size()).put(0) << head;
    return out.write(reinterpret_cast<const char*>(map.data()), 4 * map.size()).flush() ? 0 : 1;
}
