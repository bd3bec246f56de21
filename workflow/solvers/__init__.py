"""The models that are solved in this process, a module each; see `workflow.models`."""
