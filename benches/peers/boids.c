// Steps per second of processor time of PufferLib's boids, 27 in each of so many environments. Its source distribution
// holds them and raylib's headers; PACKAGE is the folder of `pip download --no-binary :all: --no-deps pufferlib==3.0.0`,
// unpacked. Nothing is drawn, so that raylib itself is left out:
//
//   gcc -O2 -flto -fwrapv -I PACKAGE/pufferlib/ocean/boids -I PACKAGE/raylib-5.5_linux_amd64/include \
//     benches/peers/boids.c -o boids -lm -Wl,--unresolved-symbols=ignore-all && ./boids 64

#include <time.h>

#include "boids.h"

enum { AGENTS = 27, SECONDS = 3 };

bool IsKeyDown(int key) { return key < 0; }
int GetMouseX(void) { return 0; }
int GetMouseY(void) { return 0; }

int main(int count, char **words) {
    unsigned envs = count > 1 ? atoi(words[1]) : 64;
    Boids *all = calloc(envs, sizeof(Boids));
    for (Boids *env = all; env < all + envs; env++) {
        env->num_boids = AGENTS;
        env->report_interval = 1;
        env->margin_turn_factor = env->avoid_factor = env->matching_factor = env->centering_factor = 1;
        env->observations = calloc(AGENTS * AGENTS * 4, sizeof(float));
        env->actions = calloc(AGENTS * 2, sizeof(float));
        env->rewards = calloc(AGENTS, sizeof(float));
        env->terminals = calloc(AGENTS, 1);
        init(env);
        c_reset(env);
        for (int k = 0; k < 2 * AGENTS; k++) env->actions[k] = rndf(-1, 1);
        c_step(env);
    }
    unsigned long done = 0;
    clock_t start = clock();
    for (; clock() - start < SECONDS * CLOCKS_PER_SEC; done += envs)
        for (Boids *env = all; env < all + envs; env++) c_step(env);
    double taken = (double)(clock() - start) / CLOCKS_PER_SEC;
    printf("boids, %u environments: %.0f steps per second of one core\n", envs, done / taken);
}
