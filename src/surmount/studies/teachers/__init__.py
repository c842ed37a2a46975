"""Which teacher helps on which kind of task: a comparison whose plan is written beforehand."""
