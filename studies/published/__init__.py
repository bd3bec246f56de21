"""The published study, whose configuration is `config.yaml` of the checkout."""
