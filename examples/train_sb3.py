"""PPO of Stable-Baselines3 on a course, with nothing in between.

python examples/train_sb3.py
"""

import gymnasium
from stable_baselines3 import PPO

import surmount.rstar  # noqa: F401  (registers the courses)


def main(steps=200_000, heights_mm=(70.0, 100.0, 130.0)):
    env = gymnasium.make("surmount/LowEntrance-v0")
    model = PPO("MlpPolicy", env, n_steps=min(2048, steps), learning_rate=3e-4, gamma=0.99, seed=0)
    model.learn(steps)

    results = {}
    for height_mm in heights_mm:
        observation, info = env.reset(seed=0, options={"variant": height_mm, "start": "fixed"})
        over = False
        while not over:
            action, _ = model.predict(observation, deterministic=True)
            observation, _, terminated, truncated, info = env.step(action)
            over = terminated or truncated
        results[height_mm] = info
        outcome = "passed" if info["is_success"] else "failed"
        print(f"{height_mm:.0f} mm: {outcome}, {info['completion_time_s']:.1f} s")
    env.close()
    return results


if __name__ == "__main__":
    main()
